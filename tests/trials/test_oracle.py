"""An oracle: the tool with the truth in its rig, whose errors those of the blind one are held against."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from exo_sim.cli import main
from exo_sim.rig import read
from exo_sim.trials import oracle, protocol
from exo_sim.trials.case_mix import draw_plans
from exo_sim.trials.cases import make_case, truth_of, write_case
from exo_sim.trials.conditions import Conditions
from exo_sim.trials.hidden_effects import LISTED

TOOL = """
import json, pathlib, sys, tomllib
out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
error = 1.0 if tomllib.loads(pathlib.Path("rig.toml").read_text()).get("effects") else 3.0
out.mkdir()
fit = {"signal": {"piston.pressure_1": {"before": 9.0, "after": error, "noise": 1.0}}}
(out / "diagnosis.json").write_text(json.dumps({"verdict": "consistent", "effects": [], "fit": fit}))
"""


@pytest.mark.parametrize("key", LISTED)
def test_a_rig_can_hold_every_listed_effect(key: str, tmp_path: Path) -> None:
    case = make_case("oracle", (key,), 3, (0.5,), Conditions(duration=4.0))
    write_case(case, tmp_path)
    hidden = truth_of(case)["hidden"]
    path = tmp_path / "rig.toml"
    path.write_text(oracle.oracle_rig(path.read_text(), hidden))
    settings = {(one.name, one.where): one for one in read(path).effects}
    for entry in hidden:
        values = settings[entry["name"], entry["where"]].parameters
        for name, given in entry["parameters"].items():
            expected = given["value"]
            assert values["sensor" if name == "sensor_at_valve" else name] == pytest.approx(expected, rel=1e-9)


def test_the_blind_error_is_held_against_the_oracles(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder, key = tmp_path / "trial", tmp_path / "trial.key"
    protocol.make(folder, draw_plans(8, 3), key, duration=4.0, quiet=True)
    (tmp_path / "tool.py").write_text(TOOL)
    tool = f"{sys.executable} {tmp_path / 'tool.py'}"
    protocol.run(folder, tool, quiet=True)
    assert main(["trial", "score", str(folder), "--oracle", "--jobs", "1", "--quiet", "--json"]) == 0
    capsys.readouterr()
    score = json.loads((folder / "score.json").read_text())
    truths = json.loads((folder / "opened.json").read_text())
    ratios = score["held_out_error_over_oracle"]["ratio"]
    assert score["held_out_error_over_oracle"]["compared"] == len(ratios)
    assert set(ratios) == {name for name, truth in truths.items() if oracle.has_oracle(truth)} != set()
    for name, ratio in ratios.items():
        known = "effects" in (folder / "cases" / name / "rig.toml").read_text()
        assert ratio == (1.0 if known else 3.0)
    near = score["figures"]["held_out_error_near_oracle"]
    assert near["of"] == len(ratios) and near["hits"] == sum(ratio == 1.0 for ratio in ratios.values())
    assert "an oracle" in (folder / "score.html").read_text()


def answer(held_out: float = 9.0, **after: float) -> dict[str, Any]:
    return {"fit": {"signal": {key: {"after": value} for key, value in after.items()}, "held_out": [[held_out, 12.0]]}}


def test_only_what_both_were_asked_is_compared() -> None:
    assert oracle.over_oracle(None, answer(a=1.0)) is None
    assert oracle.over_oracle(answer(b=2.0), answer(a=1.0)) is None
    assert oracle.over_oracle(answer(a=2.0), answer(held_out=8.0, a=1.0)) is None
    assert oracle.over_oracle(answer(a=2.0, b=9.0), answer(a=1.0)) == 2.0
