from __future__ import annotations

import json

import pytest

from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions, LegConditions
from exo_sim.trials.leg_cases import make_leg_case
from exo_sim.trials.rivals.__main__ import main


def diagnose(case, how, folder):
    path = write_case(case, folder, "parquet")[0]
    status = main([how, str(path), "--rig", str(folder / "rig.toml"), "--out", str(folder / "out")])
    return status, json.loads((folder / "out" / "diagnosis.json").read_text())


@pytest.mark.parametrize("how", ["prune", "greedy", "threshold", "ensemble"])
@pytest.mark.parametrize("key, parameter, within", [
    ("coulomb_friction", "force", 0.05), ("piston_leakage", "area", 0.05), ("valve_offset", "shift", 0.15),
    ("viscous_friction", "coefficient", 0.1),
])  # fmt: skip
def test_weak_regression_finds_the_size_of_what_was_planted(how, key, parameter, within, tmp_path):
    """An independent path from recording to parameter: the truth, its files and its units agree."""
    case = make_case("a", [key], 7, 1.0, Conditions(known=(), errors=0.0, duration=16.0))
    status, found = diagnose(case, how, tmp_path)
    entry = next(effect for effect in found["effects"] if effect["name"] == key)
    assert status == 3
    assert entry["parameters"][parameter]["value"] == pytest.approx(case.hidden[0].parameters[parameter], rel=within)


def test_nothing_finds_nothing(tmp_path):
    status, found = diagnose(make_case("a", ["valve_lag"], 7, 1.0, Conditions(duration=6.0)), "nothing", tmp_path)
    assert (status, found["verdict"], found["effects"]) == (0, "consistent", [])


def test_a_leg_is_regressed_through_its_tendons(tmp_path):
    case = make_leg_case("a", ["piston_leakage"], 3, 1.0, LegConditions(known=(), errors=0.0, duration=16.0))
    _, found = diagnose(case, "prune", tmp_path)
    entry = next(e for e in found["effects"] if e["name"] == "piston_leakage" and e["where"] == case.joint)
    assert entry["parameters"]["area"]["value"] == pytest.approx(case.hidden[0].parameters["area"], rel=0.15)


def test_a_missing_sensor_leaves_it_undetermined(tmp_path):
    case = make_case("a", [], 7, conditions=Conditions(known=(), duration=6.0, missing=("slide.position",)))
    assert diagnose(case, "prune", tmp_path)[0] == 4
