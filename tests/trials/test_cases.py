from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from exo_sim.errors import TrialError
from exo_sim.trials.case_mix import EXCLUSIVE, LEG, SHARES, draw_plans, every_plan
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions, Sensors
from exo_sim.trials.detection_limit import NEEDED, concealed, distance, ideal_limit, limit, reference_limits
from exo_sim.trials.hidden_effects import EFFECTS, LISTED, OUTSIDE, find, plant
from exo_sim.trials.truth.instruments import Instrument, measure

SHORT = Conditions(duration=4.0, known=())


@pytest.mark.parametrize("key", list(EFFECTS))
def test_every_effect_shows_at_its_own_size_and_stays_off_the_ends(key):
    with_it = make_case("a", [key], 3, 1.0, Conditions(duration=12.0, known=()))
    true = with_it.truth[0].log
    assert np.isfinite(list(true.values())).all()
    travelled = true["piston"] / with_it.bench.stroke
    assert travelled.min() > 0.0 and travelled.max() < 1.0
    if key == "sensor_gauge":
        shown = with_it.recordings[0]["piston.pressure_1 [Pa]"]
        assert np.median(true["pressure_1"] - shown) == pytest.approx(101325, abs=200)
        return
    next_to_nothing = make_case("a", [key], 3, find(key).smallest, Conditions(duration=12.0, known=()))
    noise = {"piston.pressure_1 [Pa]": 250, "piston.pressure_2 [Pa]": 250, "slide.position [m]": 2e-5}
    one, other = with_it.recordings[0], next_to_nothing.recordings[0]
    assert max(np.abs(one[name] - other[name]).max() / sigma for name, sigma in noise.items()) > 8


def test_the_names_of_the_public_list_can_all_be_planted():
    public = {
        "wall_heat_transfer", "piston_leakage", "external_leakage", "valve_null_leakage", "valve_deadband",
        "valve_offset", "valve_lag", "valve_hysteresis", "line_restriction", "exhaust_back_pressure", "supply_droop",
        "coulomb_friction", "viscous_friction", "stribeck_friction", "pressure_dependent_friction", "return_spring",
        "transmission_compliance", "backlash", "quadratic_drag", "critical_ratio", "presliding",
        "asymmetric_friction", "spool_rate_limit",
        "moving_wall_temperature", "end_cushioning", "supply_regulator", "sensor_delay", "sensor_bias", "sensor_scale",
        "flow_capacity", "dead_volume", "payload_mass",
    }  # fmt: skip
    assert public <= {effect.name for effect in EFFECTS.values()}
    assert len({EFFECTS[key].name for key in OUTSIDE}) >= 6
    assert not {EFFECTS[key].name for key in OUTSIDE} & public


def test_same_seed_same_bytes(tmp_path):
    first = write_case(make_case("a", ["piston_leakage"], 5, 1.0, SHORT), tmp_path / "1")[0]
    again = write_case(make_case("a", ["piston_leakage"], 5, 1.0, SHORT), tmp_path / "2")[0]
    assert first.read_bytes() == again.read_bytes()
    assert (tmp_path / "1" / "rig.toml").read_bytes() == (tmp_path / "2" / "rig.toml").read_bytes()


def test_a_case_is_what_its_owner_would_hand_over(tmp_path):
    import tomllib

    import mujoco

    case = make_case("a", ["stribeck_friction"], 8, 1.0, Conditions(duration=4.0))
    path = write_case(case, tmp_path)[0]
    rig = tomllib.loads((tmp_path / "rig.toml").read_text())
    model = mujoco.MjModel.from_xml_path(str(tmp_path / rig["model"]))
    assert model.actuator(rig["cylinders"]["piston"]["actuator"]).name == "piston"
    assert "coulomb_friction" in rig["effects"] and "stribeck_friction" not in rig["effects"]
    assert not (tmp_path / "truth.json").exists()
    assert path.read_text().split("\n", 1)[0].startswith("time [s],piston.valve_command [1],piston.pressure_1 [Pa]")
    area = float(rig["cylinders"]["piston"]["valve"]["area"].split()[0]) * 1e-6
    assert 0 < abs(area / case.bench.valve_area - 1) < 0.05


def test_position_and_length_agree():
    """Joint position minus retracted length is the piston's place in the cylinder, whatever zero was drawn."""
    case = next(c for c in (make_case("a", [], seed, conditions=SHORT) for seed in range(20)) if c.bench.zero > 0)
    measured = case.recordings[0]["slide.position [m]"] + case.bench.zero
    assert np.abs(measured - case.truth[0].log["piston"]).max() < 2e-4


def test_unknown_effect_is_named_with_its_neighbour():
    with pytest.raises(TrialError, match="piston_leakage"):
        make_case("a", ["piston_leekage"])


def test_instrument_delay_bias_and_bits():
    time = np.arange(2000) / 1000
    true = np.sin(2 * np.pi * time)
    rng = np.random.default_rng(1)
    late = measure(time, true, Instrument(delay=0.02), rng)
    assert late[500:] == pytest.approx(np.sin(2 * np.pi * (time[500:] - 0.02)), abs=1e-6)
    slow = measure(time, true, Instrument(lag=0.05), rng)
    gain = 1 / np.hypot(1, 2 * np.pi * 0.05)
    assert slow[1000:].max() == pytest.approx(gain, abs=2e-3)
    coarse = measure(time, true, Instrument(bits=4, low=-1.0, high=1.0), rng)
    assert len(np.unique(coarse)) == 16
    noisy = measure(time, 0 * true, Instrument(noise=1.0, slow_noise=2.0, slow_time=0.05), np.random.default_rng(3))
    assert noisy.std() == pytest.approx(np.sqrt(5), rel=0.2)
    holes = measure(time, true, Instrument(missing=((0.5, 0.6),), stuck=((1.0, 1.1),)), rng)
    assert np.isnan(holes[500:600]).all() and not np.isnan(holes[600:]).any()
    assert len(np.unique(holes[1000:1100])) == 1


def test_limit_is_where_the_likelihood_says():
    under = Conditions(duration=6.0, known=())
    assert distance(make_case("a", [], 4, conditions=under, keep_states=True)) == 0.0
    smallest = ideal_limit("piston_leakage", 4, under)
    assert distance(make_case("a", ["piston_leakage"], 4, smallest, under, keep_states=True)) == pytest.approx(NEEDED, rel=0.15)
    hypot = np.hypot(reference_limits()["piston_leakage"], NEEDED * find("piston_leakage").healthy)
    assert limit("piston_leakage") == pytest.approx(hypot, rel=1e-6)


def test_every_effect_has_a_reference_limit():
    assert set(reference_limits()) == set(EFFECTS)
    assert all(0 < value <= 8 for value in reference_limits().values())


def test_noise_raises_the_limit_in_proportion():
    quiet, loud = (
        replace(SHORT, sensors=sensors) for sensors in (Sensors(bits=0), Sensors(bits=0, pressure_noise=500.0, position_noise=4e-5))
    )
    one, two = (distance(make_case("a", ["valve_offset"], 4, 1e-3, under, keep_states=True)) for under in (quiet, loud))
    assert two < 0.75 * one


def test_concealing_moves_the_believed_numbers():
    case = make_case("a", ["valve_deadband"], 4, 1.0, conditions=Conditions(duration=6.0, known=()), keep_states=True)
    assert abs(concealed(case).believed.valve_area / case.bench.valve_area - 1) > 0.05
    assert concealed(case).recordings is case.recordings


def test_plant_keeps_its_shape_at_every_size():
    bench = make_case("a", [], 2, conditions=SHORT).bench
    small, large = (plant(find("return_spring"), bench, size, 9).parameters for size in (0.1, 1.0))
    assert small["rest"] == large["rest"]
    assert large["stiffness"] == pytest.approx(10 * small["stiffness"])


def test_mix_covers_every_cell_and_never_hides_what_excludes_itself():
    plans = draw_plans(400, 3)
    assert len(plans) == 400 and len({plan.seed for plan in plans}) > 390
    assert {plan.cell for plan in plans} == set(SHARES)
    assert {plan.effects[0] for plan in plans if plan.cell == "single"} >= set(LISTED)
    for plan in plans:
        names = {EFFECTS[key].name for key in plan.effects}
        assert len(names) == len(plan.effects)
        assert all(len(names & group) < 2 for group in EXCLUSIVE)
    assert plans == draw_plans(400, 3)


def test_every_effect_comes_as_often_as_asked_at_ten_limits():
    plans = every_plan(2, 3)
    for cell, keys in {"single": LISTED, "concealed": LISTED, "leg": LEG}.items():
        assert sorted(plan.effects[0] for plan in plans if plan.cell == cell) == sorted(2 * list(keys))
    assert all(plan.times == (10.0,) and plan.conceal == (plan.cell == "concealed") for plan in plans)
    assert len({plan.seed for plan in plans}) == len({plan.name for plan in plans}) == len(plans)
    assert [plan.seed for plan in every_plan(2, 4)] != [plan.seed for plan in plans]
