"""Cases of real machines: what is handed over, what is kept back, and the honest models against what was published."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

import numpy as np
import pytest

from exo_sim.errors import TrialError
from exo_sim.trials.real import runner, table
from exo_sim.trials.real.balance import balance_error, read_machine
from exo_sim.trials.real.case import BALANCE, TAIL
from exo_sim.trials.real.honest import honest_errors
from exo_sim.trials.real.machines import NAMES, VARIANTS, real_case, rig_of

TOOL = """import json, pathlib, shutil, sys
pathlib.Path("out").mkdir()
pathlib.Path("out/improved.toml").write_text(pathlib.Path("rig.toml").read_text().replace('model = "', 'model = "../')
    + '[effects.coulomb_friction.piston]\\nforce = "6 N"\\n')
pathlib.Path("out/diagnosis.json").write_text(json.dumps({"verdict": "mismatch", "effects": [
    {"name": "coulomb_friction", "where": "piston", "kind": "missing_physics"}]}))
"""


def test_a_machine_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(TrialError, match='no real machine "kdm"'):
        real_case("kdm", tmp_path)
    for name in ("kdn", "emps", "upright"):
        with pytest.raises(TrialError, match=r"are not in"):
            real_case(name, tmp_path)


@pytest.mark.real_data
@pytest.mark.parametrize("name", NAMES)
def test_what_is_kept_back_is_not_handed_over(name: str, shared_data: Path, repository: Path) -> None:
    case = real_case(name, shared_data)
    assert (rig_of(case, repository) / "rig.toml").exists()
    for held in case.held:
        for given in case.recordings:
            if case.measure == TAIL:
                assert given.time[-1] < held.time[-1] - 0.2 * held.duration
            else:
                place = next(key for key in given.columns if key.endswith(".position"))
                if place in held:
                    windows = np.lib.stride_tricks.sliding_window_view(given[place], 300)[:, ::30]
                    assert not (windows == held[place][100:400:30]).all(axis=1).any()


@pytest.mark.real_data
def test_thinned_variants_have_a_fifth_of_the_samples(shared_data: Path) -> None:
    for name in VARIANTS:
        if name.endswith("_20hz"):
            case, whole = real_case(name, shared_data), real_case(name.removesuffix("_20hz"), shared_data)
            for thin, run in zip(case.recordings, whole.recordings):
                assert 4 <= len(run.time) / len(thin.time) <= 6


@pytest.mark.real_data
def test_honest_models_reach_what_was_published(shared_data: Path, repository: Path) -> None:
    """3.69 N is what the published numbers leave of the pulses; the readme has 0.63 N for PK, 0.046 and 0.035 bar for the springs."""

    def honest(name: str) -> list[float]:
        case = real_case(name, shared_data)
        return list(honest_errors(case, rig_of(case, repository) / "rig.toml").values())

    assert honest("emps")[0] < 3.5
    assert honest("seal_pk")[0] == pytest.approx(0.63, abs=0.02)
    assert honest("seal_napn")[0] < 1.3
    first, second = honest("spring_moving")
    assert first < 7e3 and second < 5e3
    assert max(honest("gas_spring")) < 10e3
    assert honest("ultimaker")[0] < 2e3


@pytest.mark.real_data
def test_rigs_as_believed_miss_by_what_the_readmes_say(shared_data: Path, repository: Path) -> None:
    for name, error in (("seal_napn", 10.2), ("seal_pk", 6.6), ("emps", 38.9)):
        case = real_case(name, shared_data)
        assert case.measure == BALANCE and case.moving is not None
        found = balance_error(read_machine(rig_of(case, repository) / "rig.toml"), case.held, case.moving)
        assert found == pytest.approx(error, rel=0.02)


@pytest.mark.real_data
def test_a_tool_is_run_and_marked(shared_data: Path, repository: Path, tmp_path: Path) -> None:
    (tmp_path / "tool.py").write_text(TOOL)
    tool = f"{shlex.quote(sys.executable)} {shlex.quote(str(tmp_path / 'tool.py'))}"
    (mark,) = runner.run(("kdn",), shared_data, repository, tmp_path / "out", tool, "no compare is needed", quiet=True)
    assert mark.verdict == "mismatch" and not mark.missed and not mark.forbidden and mark.names == 1.0
    assert mark.over_before is not None and mark.over_before < 0.6
    assert mark.over_honest is not None and mark.over_honest > 3 and mark.mark == 0.5
    again = runner.run(("kdn",), shared_data, repository, tmp_path / "out", "false", "false", quiet=True)
    assert again == [mark]
    runner.write(again, tmp_path / "marks.json")
    assert (tmp_path / "marks.json").exists() and len(table.case_rows(again)[0]) == len(table.CASES)
    assert again[0].make == "printed piston" and again[0].before_over_honest == pytest.approx(mark.over_honest / mark.over_before)
