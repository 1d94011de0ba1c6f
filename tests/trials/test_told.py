"""A tool that is told what is hidden: its rig has the truth in it, and its errors are held against those of the blind one."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from exo_sim.cli import main
from exo_sim.rig import read
from exo_sim.trials import protocol, told
from exo_sim.trials.cases import make_case, truth_of, write_case
from exo_sim.trials.cells import draw_plans
from exo_sim.trials.effects import LISTED

TOOL = """
import json, pathlib, sys, tomllib
out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
error = 1.0 if tomllib.loads(pathlib.Path("rig.toml").read_text()).get("effects") else 3.0
out.mkdir()
fit = {"signal": {"piston.pressure_1": {"before": 9.0, "after": error, "noise": 1.0}}}
(out / "diagnosis.json").write_text(json.dumps({"verdict": "consistent", "effects": [], "fit": fit}))
"""


@pytest.mark.parametrize("key", LISTED)
def test_a_rig_can_be_told_every_listed_effect(key: str, tmp_path: Path) -> None:
    case = make_case("told", (key,), 3, (0.5,), duration=4.0)
    write_case(case, tmp_path)
    hidden = truth_of(case)["hidden"]
    path = tmp_path / "rig.toml"
    path.write_text(told.told_rig(path.read_text(), hidden))
    settings = {(one.name, one.where): one for one in read(path).effects}
    for entry in hidden:
        values = settings[entry["name"], entry["where"]].parameters
        for name, given in entry["parameters"].items():
            expected = given["value"]
            assert values["sensor" if name == "sensor_at_valve" else name] == pytest.approx(expected, rel=1e-9)


def test_the_blind_error_is_held_against_the_told_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder, key = tmp_path / "trial", tmp_path / "trial.key"
    protocol.make(folder, draw_plans(8, 3), key, duration=4.0, quiet=True)
    (tmp_path / "tool.py").write_text(TOOL)
    tool = f"{sys.executable} {tmp_path / 'tool.py'}"
    protocol.run(folder, tool, quiet=True)
    assert main(["trial", "score", str(folder), "--told", "--jobs", "1", "--quiet", "--json"]) == 0
    capsys.readouterr()
    score = json.loads((folder / "score.json").read_text())
    truths = json.loads((folder / "opened.json").read_text())
    ratios = score["held_out_error_over_told"]["ratio"]
    assert score["held_out_error_over_told"]["told"] == len(ratios)
    assert set(ratios) == {name for name, truth in truths.items() if told.can_be_told(truth)} != set()
    for name, ratio in ratios.items():
        known = "effects" in (folder / "cases" / name / "rig.toml").read_text()
        assert ratio == (1.0 if known else 3.0)
    near = score["figures"]["held_out_error_near_told"]
    assert near["of"] == len(ratios) and near["hits"] == sum(ratio == 1.0 for ratio in ratios.values())
    assert "told what is hidden" in (folder / "score.html").read_text()


def answer(held_out: float = 9.0, **after: float) -> dict[str, Any]:
    return {"fit": {"signal": {key: {"after": value} for key, value in after.items()}, "held_out": [[held_out, 12.0]]}}


def test_only_what_both_were_asked_is_compared() -> None:
    assert told.over_told(None, answer(a=1.0)) is None
    assert told.over_told(answer(b=2.0), answer(a=1.0)) is None
    assert told.over_told(answer(a=2.0), answer(held_out=8.0, a=1.0)) is None
    assert told.over_told(answer(a=2.0, b=9.0), answer(a=1.0)) == 2.0
