from __future__ import annotations

import tomllib
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from exo_sim.errors import TrialError
from exo_sim.trials.cases import truth_of, write_case
from exo_sim.trials.conditions import LegConditions
from exo_sim.trials.leg_cases import FORCE, GAS, make_leg_case
from exo_sim.trials.truth.leg import JOINTS, length

SHORT = LegConditions(duration=12.0, known=())


@pytest.fixture(scope="module")
def case():
    return make_leg_case("a", [], 2, conditions=replace(SHORT, load_cell=True))


def test_lengths_are_those_of_the_tendons(case):
    model = mujoco.MjModel.from_xml_string(case.bench.model())
    data = mujoco.MjData(model)
    rng = np.random.default_rng(1)
    for _ in range(20):
        for joint in JOINTS:
            low, high = model.joint(joint).range
            data.joint(joint).qpos = rng.uniform(low, high)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_tendon(model, data)
        for joint in JOINTS:
            angle = data.joint(joint).qpos
            assert data.tendon(joint).length == pytest.approx(length(joint, angle), rel=1e-12)


def test_led_piston_follows_the_recorded_angle(case):
    for joint, truth in case.truth.items():
        measured = case.recordings[0][f"{joint}.position [rad]"]
        place = length(joint, measured) + case.bench.cylinders[joint].zero
        assert np.abs(place - truth.log["piston"]).max() < 1e-4


def test_closed_cylinder_without_heat_keeps_its_isentrope(case):
    """Standing with the valve shut, p V^k stays what it was."""
    for joint, truth in case.truth.items():
        bench = case.bench.cylinders[joint]
        log = truth.log
        rows = slice(0, round(0.05 * len(log["time"])))
        assert np.all(log["command"][rows] == 0)
        law_1 = log["pressure_1"][rows] * (bench.dead_1 + bench.area_1 * log["piston"][rows]) ** 1.4
        law_2 = log["pressure_2"][rows] * (bench.dead_2 + bench.area_2 * (bench.stroke - log["piston"][rows])) ** 1.4
        assert np.ptp(law_1) / law_1[0] < 1e-6
        assert np.ptp(law_2) / law_2[0] < 1e-6


def test_load_cell_feels_gas_without_friction_and_less_with(case):
    joint = case.joint
    log, bench = case.truth[joint].log, case.bench.cylinders[joint]
    gas = log["pressure_1"] * bench.area_1 - log["pressure_2"] * bench.area_2
    gas -= bench.ambient * (bench.area_1 - bench.area_2)
    assert np.abs(log["force"] - gas).max() < 1e-6
    rough = make_leg_case("a", ["coulomb_friction"], 2, conditions=SHORT)
    log, force = rough.truth[joint].log, rough.hidden[0].parameters["force"]
    gas = log["pressure_1"] * bench.area_1 - log["pressure_2"] * bench.area_2
    gas -= bench.ambient * (bench.area_1 - bench.area_2)
    sliding = np.abs(log["velocity"]) > 0.05
    assert np.median(np.abs((gas - log["force"])[sliding])) == pytest.approx(force, rel=0.02)


@pytest.mark.parametrize("key", GAS + FORCE)
def test_every_effect_of_a_leg_shows(key):
    plain, with_it = (make_leg_case("a", [key], 5, size, SHORT) for size in (0.05, 1.0))
    joint = with_it.joint
    assert with_it.hidden[0].effect.where.startswith(joint)
    noise = {f"{joint}.pressure_1 [Pa]": 500, f"{joint}.pressure_2 [Pa]": 500, f"{joint}.force [N]": 0.5}
    one, other = plain.recordings[0], with_it.recordings[0]
    # a command that differs is a difference too: the loop answers what is hidden
    moved = [np.abs(one[name] - other[name]).max() / sigma for name, sigma in noise.items() if name in one]
    assert max(moved) > 4


def test_a_leg_is_what_its_owner_would_hand_over(case, tmp_path):
    path = write_case(case, tmp_path)[0]
    rig = tomllib.loads((tmp_path / "rig.toml").read_text())
    model = mujoco.MjModel.from_xml_path(str(tmp_path / rig["model"]))
    assert {model.actuator(c["actuator"]).name for c in rig["cylinders"].values()} == set(JOINTS)
    header = path.read_text().split("\n", 1)[0].split(",")
    assert {"hip_r.position [rad]", "knee_r.pressure_2 [Pa]", "hip_r.force [N]", "supply.pressure [Pa]"} <= set(header)
    truth = truth_of(case)
    assert truth["hidden"] == [] and set(truth["bench"]) == set(JOINTS)


def test_what_a_leg_cannot_show_is_refused():
    with pytest.raises(TrialError, match="cannot be planted in a leg"):
        make_leg_case("a", ["payload_mass"])


def test_distance_of_a_leg_is_nothing_without_and_large_with():
    from exo_sim.trials.leg_detection_limit import distance

    assert distance(make_leg_case("a", [], 3, conditions=LegConditions(known=(), duration=8.0))) == pytest.approx(0.0, abs=1e-6)
    near, far = (distance(make_leg_case("a", ["valve_offset"], 3, s, LegConditions(known=(), duration=8.0))) for s in (1e-4, 1e-3))
    assert far == pytest.approx(10 * near, rel=0.3)
    assert distance(make_leg_case("a", ["piston_leakage"], 3, 1.0, LegConditions(known=(), duration=8.0))) > 100
