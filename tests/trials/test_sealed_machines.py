"""Whole machines under seal: what is handed over, what is not, and what counts when the seals are open."""

from __future__ import annotations

import json
import shlex
import shutil
import sys
from collections import Counter
from pathlib import Path

import pytest

from exo_sim.cli import main
from exo_sim.errors import TrialError
from exo_sim.trials import protocol
from exo_sim.trials import sealed_machines as sealed

TOOL = """
import json, pathlib, sys
given = {p.name for p in pathlib.Path(".").iterdir()} - {"words"}
assert given == {"rig.toml", "bench.xml", "recording.csv"}, given
out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
out.mkdir()
(out / "diagnosis.json").write_text(json.dumps({"verdict": "mismatch", "effects": [
    {"name": "coulomb_friction", "where": "piston", "kind": "missing_physics"}]}))
(out / "improved.toml").write_text(pathlib.Path("rig.toml").read_text().replace("bench.xml", "../bench.xml"))
"""
COMPARE = """
import json, pathlib, sys
rig = pathlib.Path(sys.argv[sys.argv.index("--rig") + 1])
assert pathlib.Path(sys.argv[1]).name == "fresh.csv" and (rig.parent / "bench.xml").exists() or rig.name == "improved.toml"
error = {"rig.toml": 4.0, "improved.toml": 2.0, "nearest.toml": 1.0}[rig.name]
print(json.dumps({"signal": {"p": {"windowed_rms": error, "free_run_rms": error, "noise": 0.1}}}))
"""


def command(folder: Path, name: str, text: str) -> str:
    (folder / name).write_text(text)
    return f"{shlex.quote(sys.executable)} {shlex.quote(str(folder / name))}"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    root = tmp_path_factory.mktemp("whole")
    plans = sealed.draw_plans(2, 3, ("A",), ("single",))
    protocol.make(root / "trial", plans, root / "key", 4.0, fmt="csv", quiet=True, truth="whole", one=sealed.make_one)
    return root


@pytest.fixture
def done(made, tmp_path):
    root = tmp_path / "copy"
    shutil.copytree(made, root)
    protocol.run(root / "trial", command(root, "tool.py", TOOL), quiet=True)
    return root


def test_every_make_and_cell_has_its_share():
    plans = sealed.draw_plans(60, 1, ("E", "F", "J"))
    assert plans == sealed.draw_plans(60, 1, ("E", "F", "J")) != sealed.draw_plans(60, 2, ("E", "F", "J"))
    assert Counter(plan.make for plan in plans) == {"E": 20, "F": 20, "J": 20}
    assert Counter(plan.cell for plan in plans) == {"whole": 36, "single": 9, "nothing": 9, "outside": 6}
    assert len({plan.seed for plan in plans}) == 60 and len({plan.name for plan in plans}) == 60
    assert Counter(plan.cell for plan in sealed.draw_plans(9, 1, ("E",), ("whole", "nothing")))["whole"] in (4, 5)


def test_nothing_of_the_truth_is_handed_over(made):
    for case in (made / "trial" / "cases").iterdir():
        assert {path.name for path in case.iterdir()} == {"rig.toml", "bench.xml", "recording.csv"}
    for path in (made / "trial").rglob("*"):
        assert path.is_dir() or b"nearest.toml" not in path.read_bytes()


def test_opened_they_are_marked_and_their_rigs_are_held_against_what_nobody_saw(done):
    compare = command(done, "compare.py", COMPARE)
    found = sealed.score(done / "trial", done / "key", compare=compare, quiet=True)
    (group,) = found["figures"].values()
    figures = group["lines"]["single"]
    assert figures["cases"] == 2 and figures["recall"]["of"] <= 2
    assert figures["windowed_rms_after_over_before"]["median"] == 0.5 and figures["windowed_rms_after_over_nearest"]["median"] == 2.0
    assert figures["worse"]["hits"] == 0 and found["truth"] == "whole"
    assert json.loads((done / "trial" / "score.json").read_text())["figures"] == found["figures"]
    assert "| makes for learning |" in (done / "trial" / "score.md").read_text()
    again = sealed.score(done / "trial", done / "key", compare="false", quiet=True)  # what was held against it is kept
    assert again["figures"] == found["figures"]


def test_a_rig_altered_after_its_verdict_is_found_out(done):
    path = next((done / "trial" / "run").glob("*/improved.toml"))
    path.write_text(path.read_text() + "\n")
    with pytest.raises(TrialError, match="not the rig that was signed"):
        sealed.score(done / "trial", done / "key", compare="false", quiet=True)


def test_wishes_that_do_not_go_together_are_named(tmp_path, capsys):
    for words, said in (
        (("--make", "E"), "--truth whole"),
        (("--truth", "whole", "--every", "2"), "--every"),
        (("--truth", "whole", "--make", "Y"), 'no make "Y"'),
        (("--truth", "whole", "--cell", "hole"), 'no cell "hole"'),
    ):
        assert main(["trial", "make", "--out", str(tmp_path / "t"), *words]) == 2
        assert said in capsys.readouterr().err
    assert not (tmp_path / "t").exists()


@pytest.mark.slow
def test_as_a_user_makes_runs_and_scores_them(tmp_path, capsys):
    trial, key = str(tmp_path / "trial"), str(tmp_path / "key")
    line = ["trial", "make", "--truth", "whole", "--make", "A", "--cell", "nothing", "--cases", "1", "--duration", "4 s", "--jobs", "1"]
    assert main([*line, "--out", trial, "--key", key]) == 0
    assert main(["trial", "run", trial, "--tool", command(tmp_path, "tool.py", TOOL), "--jobs", "1"]) == 0
    capsys.readouterr()
    assert main(["trial", "score", trial, "--key", key, "--jobs", "1"]) == 0
    assert "confidently wrong" in capsys.readouterr().out


@pytest.mark.parametrize(
    "makes, cells, says",
    [("", None, 'no make ""'), ("A,", None, 'no make ""'), (None, "", 'no cell ""'), (None, "whole,,", 'no cell ""')],
)
def test_an_empty_list_of_makes_or_cells_is_no_list_left_out(makes: str | None, cells: str | None, says: str) -> None:
    with pytest.raises(TrialError, match=says):
        sealed.plans_of("whole", 1, 0, makes, cells)
