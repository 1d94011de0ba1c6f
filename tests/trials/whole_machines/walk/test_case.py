"""Worn machines: where their cylinders sit, how they are led, and that their files mean what the contract says."""

from __future__ import annotations

import json
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import TrialError
from exo_sim.machine.rig_model import load
from exo_sim.recording import read
from exo_sim.trials.whole_machines.makes import MAKES
from exo_sim.trials.whole_machines.walk import case as cases
from exo_sim.trials.whole_machines.walk.anatomy import draw_seats, reach
from exo_sim.trials.whole_machines.walk.case import make_worn_case, truth_of, write_worn_case
from exo_sim.trials.whole_machines.walk.gait import JOINTS, PACES, RANGE, gait
from exo_sim.trials.whole_machines.walk.worn import draw_worn

WORN = [make for make in MAKES.values() if make.build == "legs"]


@pytest.fixture(scope="module")
def walked():
    return make_worn_case("walked", "K", seed=5, duration=6.0, weigh=False)


def test_nobody_leaves_the_range_that_cylinders_are_chosen_for():
    time = np.arange(0.0, 20.0, 2e-3)
    for seed in range(6):
        angles, still = gait(tuple(PACES), time, np.random.default_rng(seed))
        assert set(angles) == set(JOINTS) and 0.02 < still.mean() < 0.3
        for name, values in angles.items():
            low, high = RANGE[name.partition("_")[0]]
            assert low < values.min() and values.max() < high
            assert np.abs(np.diff(values)).max() < 15.0 * 2e-3  # no joint of a walking person turns faster than 15 rad/s


def test_legs_are_half_a_stride_apart():
    time = np.arange(0.0, 12.0, 2e-3)
    angles, _ = gait(("walk",), time, np.random.default_rng(0))
    right, left = (angles[name][2000:5000] - angles[name][2000:5000].mean() for name in ("hip_r", "hip_l"))
    stride = 1.0 / PACES["walk"]
    late = [np.corrcoef(right[: -int(lag / 2e-3)], left[int(lag / 2e-3) :])[0, 1] for lag in (0.5 * stride, stride)]
    assert late[0] > 0.8 > 0.0 > late[1]


def test_tendons_of_the_model_are_as_long_as_the_cylinders(tmp_path, walked):
    write_worn_case(walked, tmp_path)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "legs.xml"))
    data = mujoco.MjData(model)
    for angle in (-0.5, -0.1, 0.2):
        for name in walked.worn.cylinders:
            data.joint(name).qpos = angle
        mujoco.mj_forward(model, data)
        for name, seat in walked.worn.seats.items():
            assert data.tendon(name).length[0] == pytest.approx(float(seat.length(np.array([angle]))[0]), abs=1e-6)


def test_seats_reach_no_further_than_any_gait():
    for seed in range(10):
        for name, seat in draw_seats(np.random.default_rng(seed)).items():
            low, high = reach(name, seat)
            assert 0.05 < low < high < 0.6 and 0.02 < high - low < 0.15


@pytest.mark.parametrize("make", WORN, ids=lambda make: make.name)
def test_effects_sit_in_one_to_four_cylinders_and_seals_only_where_they_show(make):
    silent = {"coulomb", "viscous", "stribeck", "pressure", "asymmetry"}
    counts = set()
    for seed in range(12):
        worn = draw_worn(make, "whole", np.random.default_rng(seed))
        hidden = {name: one.hidden for name, one in worn.cylinders.items() if one.hidden}
        counts.add(len(hidden))
        assert 1 <= len(hidden) <= len(worn.cylinders)
        assert worn.load_cells or not silent & {key for keys in hidden.values() for key in keys}
        assert all(not set(one.hidden) & set(one.known) for one in worn.cylinders.values())
    assert len(counts) > 1
    assert not any(one.hidden for one in draw_worn(make, "nothing", np.random.default_rng(0)).cylinders.values())


def test_what_is_handed_over_is_read_by_the_contract_and_hides_what_is_hidden(tmp_path, walked):
    write_worn_case(walked, tmp_path)
    recording = read(tmp_path / "recording.csv", None).recording
    for name in walked.worn.cylinders:
        assert {f"{name}.valve_command", f"{name}.pressure_1", f"{name}.pressure_2", f"{name}.position"} <= set(recording.columns)
    truth = json.loads(json.dumps(truth_of(walked)))
    assert truth["hidden"] and {entry["where"] for entry in truth["hidden"]} <= set(walked.worn.cylinders)
    for file in ("rig.toml", "truth/nearest.toml"):
        machine = rigs.read(tmp_path / file)
        assert load(machine).nu == len(walked.worn.cylinders)
        listed = {(effect.name, effect.where) for effect in machine.effects}
        for entry in truth["hidden"]:
            assert ((entry["name"], entry["where"]) in listed) is (file != "rig.toml") or entry["kind"] == "outside"


def test_the_same_seed_gives_the_same_bytes(tmp_path, walked):
    again = make_worn_case("walked", "K", seed=5, duration=6.0, weigh=False)
    for folder, case in (("one", walked), ("two", again)):
        write_worn_case(case, tmp_path / folder)
    for file in ("rig.toml", "legs.xml", "recording.csv", "truth/truth.json", "truth/fresh.csv", "truth/nearest.toml"):
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()


@pytest.mark.slow
def test_led_by_its_wearer_the_nearest_rig_holds_the_pressures(tmp_path, monkeypatch):
    """Laws that the contract has and a dead band that only one cylinder hides: the rig that lists it is within 0.02 bar."""
    from exo_sim.simulation import replay as replays

    own = MAKES["K"]
    monkeypatch.setitem(MAKES, "K", replace(own, laws=replace(own.laws, flow=0)))
    monkeypatch.setattr("exo_sim.trials.whole_machines.walk.worn.COMMON", {"heat": 1.0, "deadband": 1.0, "flow": 1.0})
    case = make_worn_case("x", "K", "single", 5, effects=("deadband",), duration=8.0, weigh=False)
    write_worn_case(case, tmp_path)
    fresh = read(tmp_path / "truth" / "fresh.csv", None).recording
    errors = {}
    for file in ("truth/nearest.toml", "rig.toml"):
        machine = rigs.read(tmp_path / file)
        recorded, _ = replays.usable(fresh, machine, load(machine))
        replay = replays.replay(recorded, machine, load(machine))
        errors[file] = max(replays.rms(recorded[key], replay.windowed[key]) for key in recorded.columns if ".pressure_" in key)
    assert errors["truth/nearest.toml"] < 2e3 < 5e3 < errors["rig.toml"]


def test_bad_wishes_are_named(monkeypatch):
    with pytest.raises(TrialError, match='no make "Z"'):
        make_worn_case("x", "Z")
    with pytest.raises(TrialError, match='no effect "ded"'):
        make_worn_case("x", "K", effects=["ded"])

    def never(*_):
        raise TrialError("met an end")

    monkeypatch.setattr(cases, "walk", never)
    with pytest.raises(TrialError, match="in a row"):
        make_worn_case("x", "K")
