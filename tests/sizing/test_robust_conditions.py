"""Conditions around those asked for, and wearers of other heights."""

import pytest

from exo_sim.sizing.coupled_stride import CoupledStride, mean_of
from exo_sim.sizing.loads import Condition, joint_loads
from exo_sim.sizing.robust_conditions import FAST, SHORT, SLOW, TALL, around


def test_corners_come_once_a_scenario_with_its_largest_payload():
    asked = (Condition("level_walk", 20.0), Condition("level_walk", 34.0), Condition("squat", 10.0))
    found = around(asked)
    assert found[:3] == asked and len(found) == len(set(found)) == 9
    assert Condition("level_walk", 34.0, FAST, SHORT) in found and Condition("level_walk", 34.0, SLOW, TALL) in found
    assert Condition("squat", 0.0) in found
    assert around((found[0], Condition("level_walk", 0.0))).count(Condition("level_walk", 0.0)) == 1


def test_a_wearer_of_another_height_has_the_same_build(exo):
    rig = Condition("level_walk", 34.0, height=1.90).worn(exo)
    assert rig.wearer.height == 1.90
    assert rig.wearer.mass / 1.90**2 == pytest.approx(exo.wearer.mass / exo.wearer.height**2)
    assert Condition("level_walk", 34.0).worn(exo) is exo
    assert "1.90 m" in str(Condition("level_walk", 34.0, height=1.9)) and "wearer" not in str(Condition("level_walk", 34.0))


def test_loads_and_cycle_are_those_of_the_wearer(exo, loads):
    tall = Condition("level_walk", 34.0, height=1.90)
    theirs = joint_loads(exo, tall)
    assert abs(theirs.column("knee_r")[2]).max() != pytest.approx(abs(loads.column("knee_r")[2]).max(), rel=1e-3)
    own, other = CoupledStride(exo, loads.condition).run(exo), CoupledStride(exo, tall).run(exo)
    both = mean_of([own, other])
    assert both.gas == pytest.approx(0.5 * (own.gas + other.gas)) and both.most_gas == max(own.gas, other.gas)
    assert both.gas != pytest.approx(own.gas, rel=1e-4)
