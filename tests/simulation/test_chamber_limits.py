"""What chambers hold beyond what they should see, as torques, and a demand that pays for it."""

import dataclasses
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.control.load_weights import Weights
from exo_sim.rig.limits import rating
from exo_sim.simulation.chamber_limits import PRESSED_FROM, ChamberLimits
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request, Walk, default_rig, rig_at_250_psi
from exo_sim.simulation.worn import Simulation


@pytest.fixture(scope="module")
def simulation() -> Simulation:
    return Simulation(rigs.read(default_rig()), Request("level_walk", 34.0, cycles=4, law="inverse_dynamics"))


def test_a_chamber_beyond_its_limit_is_a_torque_that_goes_with_half_of_the_joints(simulation: Simulation) -> None:
    rig = simulation.rig
    it = ChamberLimits.of(rig, simulation.model, simulation.motion)
    knee = it.names.index("knee_r")
    cylinder = rig.cylinders["knee_r"]
    allowed = rating(rig, cylinder)
    assert allowed is not None and it.most[knee] == pytest.approx(PRESSED_FROM * allowed[0])
    n = len(it.arm)
    columns = {f"{name}.pressure_{side}": np.full(n, 6.0e5) for name in it.names for side in (1, 2)}
    columns["knee_r.pressure_2"][5] = it.most[knee] + 1.0e5
    beyond, where = it.passed(cast(Walk, cast(Any, SimpleNamespace(columns=columns))))
    pressed, presses = it.torques(beyond, where)
    assert pressed[5, it.joint[knee]] == pytest.approx(-1.0e5 * cylinder.area_2 * it.arm[5, knee])
    assert presses[5, it.joint[knee]] == 0.5
    pressed[5, it.joint[knee]] = presses[5, it.joint[knee]] = 0.0
    assert not pressed.any() and not presses.any()


def test_arms_are_those_with_which_cylinders_make_torques(simulation: Simulation) -> None:
    simulation.reset()
    walk = simulation.run()
    it = ChamberLimits.of(simulation.rig, simulation.model, simulation.motion)
    for k, name in enumerate(it.names):
        joint = ("hip_l", "knee_l", "ankle_l", "hip_r", "knee_r", "ankle_r")[it.joint[k]]
        force, torque = walk.columns[f"{name}.force"], walk.columns[f"{joint}.torque"]
        phase = walk.time / walk.motion.period
        arm = np.interp(phase % 1.0, np.arange(len(it.arm)) / len(it.arm), it.arm[:, k], period=1.0)
        assert np.corrcoef(arm * force, torque)[0, 1] > 0.95


def test_where_the_supply_is_above_the_rating_nothing_has_a_limit() -> None:
    rig = rigs.read(rig_at_250_psi())
    simulation = Simulation(rig, Request("level_walk", 34.0, cycles=1, law="inverse_dynamics"))
    assert ChamberLimits.of(rig, simulation.model, simulation.motion).names == ()


def test_a_demand_that_pays_for_pressure_presses_chambers_less() -> None:
    rig = rigs.read(default_rig())
    peaks = []
    for pressed in (0.0, Weights().pressed):
        asked = Request("fast_walk", 34.0, cycles=5, weights=dataclasses.replace(Weights(), pressed=pressed))
        summary = summarise(Simulation(rig, asked).run())
        peaks.append(max(one["pressure_peak_pa"] for one in summary["cylinders"].values()))
        assert summary["wearer"]["metabolic_w"]["value"] < 0.9 * summary["compared_with"]["backpack"]["metabolic_w"]
    assert peaks[1] < peaks[0] - 0.3e5
