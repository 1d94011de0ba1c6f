"""Marks of whole machines: what counts as right, optional, wrong, and what is counted."""

from __future__ import annotations

import json
import sys
from typing import Any

from exo_sim.trials.whole_machines import diagnose_cases, score_tables, unseen_recording
from exo_sim.trials.whole_machines.judge import judge


def hidden(name, worst, family, **more):
    entry = {"name": name, "key": name, "where": "ram", "places": ["ram", "table"], "also": [], "family": family,
             "kind": "missing_physics", "parameters": {}, "matters": {"worst": worst}}  # fmt: skip
    return entry | more


TRUTH = {
    "case": "c", "cell": "whole", "make": "A", "reported_only": False, "known": ["valve_lag"], "beside": ["presliding"],
    "hidden": [
        hidden("coulomb_friction", 40.0, "friction",
               parameters={"force": {"value": 10.0, "low": 9.5, "high": 10.5, "unit": "N"}}),
        hidden("stribeck_friction", 9.0, "friction"),
        hidden("piston_leakage", 0.4, "leak"),
        hidden("valve_deadband", 5.0, "valve", also=["valve_edges"]),
    ],
    "columns": {"ram.pressure_1": {"late": 1.4e-3, "offset": 900.0, "scale": 1.0}},
}  # fmt: skip


def said(*entries, verdict="mismatch"):
    return {"verdict": verdict, "effects": list(entries)}


def one(name, where="ram", kind="missing_physics", **more):
    return {"name": name, "where": where, "kind": kind, "evidence": {"log10_odds": 30.0}} | more


ALL = (one("coulomb_friction"), one("stribeck_friction", "table"), one("valve_edges"))


def test_all_that_matters_and_nothing_else_is_exact():
    mark = judge(TRUTH, said(*ALL))
    assert mark.exact and mark.class_exact and mark.found == (True, True, True) and not mark.wrong


def test_what_does_not_matter_may_be_named_or_not():
    mark = judge(TRUTH, said(*ALL, one("piston_leakage"), one("presliding"), one("valve_lag"), one("flow_capacity", kind="calibration")))
    assert mark.exact and mark.right.count("piston_leakage") == 1 and set(mark.neutral) == {"presliding", "valve_lag"}
    assert judge(TRUTH, said(*ALL), matters=0.1).found == (True, True, False, True)


def test_a_name_of_the_right_family_counts_as_class():
    mark = judge(TRUTH, said(ALL[0], one("quadratic_drag"), ALL[2]))
    assert not mark.exact and mark.class_exact and mark.wrong == ("quadratic_drag",) and mark.confidently_wrong == ("quadratic_drag",)
    assert not judge(TRUTH, said(*ALL, one("return_spring"))).class_exact


def test_sensors_are_wrong_unless_they_are_really_so():
    late = one("sensor_delay", "ram.pressure_1", "sensor", parameters={"seconds": {"value": 1.4e-3}})
    off = one("sensor_bias", "ram.pressure_1", "sensor", parameters={"value": {"value": 800.0}})
    assert judge(TRUTH, said(*ALL, late)).false_sensors == ("sensor_delay",)  # what an ordinary filter does
    assert judge(TRUTH, said(*ALL, off)).exact


def test_unknown_is_no_wrong_name_but_not_exact_either():
    mark = judge(TRUTH, said(*ALL, one("unknown")))
    assert not mark.exact and not mark.wrong and mark.unknown == ("ram",)
    outside = TRUTH | {
        "hidden": [hidden("warm", 30.0, "friction", kind="outside", also=["warming_friction"])],
        "beside": ["coulomb_friction"],
    }
    assert judge(outside, said(one("unknown"))).exact
    assert judge(outside, said(one("warming_friction"))).exact
    assert not judge(outside, said()).exact
    assert judge(outside, said(one("coulomb_friction"))).class_exact


def test_nothing_hidden_and_nothing_named():
    empty = TRUTH | {"hidden": []}
    assert judge(empty, said(verdict="consistent")).exact
    assert judge(empty, said(one("coulomb_friction"))).wrong == ("coulomb_friction",)
    assert not judge(empty, None).exact


def test_intervals_cover_what_the_truth_allows():
    wide = one("coulomb_friction", parameters={"force": {"value": 11.0, "low": 10.4, "high": 11.6}})
    narrow = one("coulomb_friction", parameters={"force": {"value": 11.0, "low": 10.8, "high": 11.2}})
    assert judge(TRUTH, said(wide)).parameters == (("coulomb_friction.force", 0.1, True),)
    assert not judge(TRUTH, said(narrow)).parameters[0][2]


def test_probabilities_are_kept_for_their_calibration():
    mark = judge(TRUTH, said(one("coulomb_friction", probability=0.97), one("return_spring", probability=0.6)))
    assert mark.probabilities == ((0.97, True), (0.6, False)) and not mark.confidently_wrong
    assert score_tables.calibration([mark])[0][0] == "0.600"


def write_case(folder, truth):
    (folder / "truth").mkdir(parents=True)
    (folder / "truth" / "truth.json").write_text(json.dumps(truth))
    for name in ("rig.toml", "recording.csv", "bench.xml", "truth/nearest.toml", "truth/fresh.csv"):
        (folder / name).write_text("x")


def test_the_runner_goes_on_and_never_shows_the_truth(tmp_path):
    for name in ("c1", "c2"):
        write_case(tmp_path / "cases" / name, TRUTH | {"case": name})
    tool = tmp_path / "tool.py"
    tool.write_text(
        "import json, os, pathlib, sys\n"
        "assert not any('truth' in name for name in os.listdir('.')), os.listdir('.')\n"
        "pathlib.Path('out').mkdir()\n"
        f"pathlib.Path('out/diagnosis.json').write_text({json.dumps(json.dumps(said(*ALL)))})\n"
    )
    compare = tmp_path / "compare.py"
    signal = {"ram.pressure_1": {"windowed_rms": 200.0, "free_run_rms": 300.0, "noise": 250.0}}
    compare.write_text(f"print({json.dumps(json.dumps({'signal': signal}))})\n")
    settings: dict[str, Any] = {"tool": f"{sys.executable} {tool}", "compare": f"{sys.executable} {compare}", "quiet": True}
    assert diagnose_cases.run(tmp_path / "cases", tmp_path / "out", only="c1", **settings) == 1
    assert diagnose_cases.run(tmp_path / "cases", tmp_path / "out", **settings) == 1
    assert diagnose_cases.run(tmp_path / "cases", tmp_path / "out", **settings) == 0
    marks = diagnose_cases.marks(tmp_path / "cases", tmp_path / "out")
    assert [mark.exact for mark in marks] == [True, True]
    rows = score_tables.rows(marks, score_tables.NAMES)
    assert rows[0][:3] == ["whole", "2", "100 % (54-100) of 6"] and len(rows) == 1
    assert score_tables.names(marks)[0][0] == "coulomb_friction"


def of_make(make, reported, *entries, after=None):
    errors = {"windowed_rms_after_over_before": after, "windowed_rms_after_over_nearest": after}
    return judge(TRUTH | {"make": make, "reported_only": reported}, said(*entries), errors if after else None, 10.0)


def test_makes_for_learning_and_makes_reported_on_are_never_mixed():
    marks = [of_make("A", False, *ALL), of_make("B", False), of_make("C", False, ALL[0]), of_make("E", True, *ALL), of_make("F", True)]
    learnt, reported = score_tables.groups(marks).values()
    assert {mark.make for mark in learnt} == {"A", "B", "C"} and {mark.make for mark in reported} == {"E", "F"}
    recall = {name: score_tables.figures(those)["recall"] for name, those in score_tables.lines(learnt)}
    assert list(recall) == ["whole", *(f"whole{one} {make}" for make in "ABC" for one in (", make", " without"))]
    assert recall["whole"]["hits"] == 4 and recall["whole"]["of"] == 9
    assert recall["whole, make A"]["share"] == 1.0 and recall["whole without A"]["hits"] == 1 and recall["whole without A"]["of"] == 6
    text = score_tables.tables(marks)
    assert text.count(f"| {score_tables.LEARNT} |") == 2 and text.count(f"| {score_tables.REPORTED} |") == 2
    assert set(json.loads(json.dumps(score_tables.plain(marks)))) == {score_tables.LEARNT, score_tables.REPORTED}


def test_only_rigs_that_were_tried_count_as_worse():
    found = score_tables.figures([of_make("A", False, *ALL, after=0.5), of_make("A", False, *ALL, after=1.1), of_make("A", False)])
    assert found["worse"]["hits"] == 1 and found["worse"]["of"] == 2
    assert found["windowed_rms_after_over_before"] == {"median": 0.8, "most": 1.1}
    assert found["free_run_rms_after_over_before"] is None
    endless = [of_make("A", False, after=float("inf")), of_make("A", False, after=0.5), of_make("A", False, after=0.6)]
    assert score_tables.figures(endless)["windowed_rms_after_over_before"] == {"median": 0.6, "most": None}
    assert "| 0.6 (most inf) |" in score_tables.tables(endless)


def test_ratios_never_go_below_the_noise():
    a = {"s": {"windowed_rms": 10.0, "noise": 100.0}}
    b = {"s": {"windowed_rms": 400.0, "noise": 100.0}}
    assert unseen_recording._ratio(a, b, "windowed_rms") == 0.25
    assert unseen_recording._ratio({"s": {"windowed_rms": None, "noise": 1.0}}, b, "windowed_rms") == float("inf")
