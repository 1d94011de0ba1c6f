"""Plans of a whole machine: both legs share one, half a cycle apart, and a machine without independent edges has none."""

from dataclasses import replace

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.control.pressure_plan import INTERVALS
from exo_sim.simulation.walk import Request, rig_at_250_psi
from exo_sim.simulation.worn import Simulation


@pytest.fixture(scope="module")
def walking():
    plain = rigs.read(rig_at_250_psi())
    edges = {name: replace(c, valve=replace(c.valve, independent=True)) for name, c in plain.cylinders.items()}
    return [Simulation(rig, Request("level_walk", 34.0, law="inverse_dynamics")) for rig in (plain, replace(plain, cylinders=edges))]


def test_only_independent_edges_are_planned(walking):
    four, own = walking
    assert len(four.plan) == 0
    assert own.plan.shape == (INTERVALS + 1, 2 * len(own.plugin.links))
    assert np.array_equal(own.plan[0], own.plan[-1])
    assert own.plan.min() >= own.rig.environment.pressure - 1.0
    assert own.plan.max() <= own.rig.supply.pressure


def test_both_legs_follow_one_plan_half_a_cycle_apart(walking):
    own = walking[1]
    names = list(own.rig.cylinders)
    for joint in ("hip", "knee"):
        left, right = (own.plan[:-1, 2 * names.index(f"{joint}_{side}") :][:, :2] for side in "lr")
        assert np.array_equal(right, np.roll(left, INTERVALS // 2, axis=0))


def test_a_controller_that_looks_only_at_errors_has_no_plan(walking):
    rig = walking[1].rig
    assert len(Simulation(rig, Request("level_walk", 34.0, law="inverse_dynamics", controller="pi")).plan) == 0
