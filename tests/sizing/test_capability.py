"""Capability: statics in closed form, flow that balances growth, and limits of slow and fast pistons."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from exo_sim.physics.nozzle import critical_flow_factor, flow
from exo_sim.rig import EffectSetting, assembly
from exo_sim.sizing.capability import driving_force, steady_pressure

K, R, T, PA = 1.4, 287.05, 293.15, 101325.0


def _record(rig, name="knee_l"):
    return assembly.world(rig)[0], assembly.cylinders(rig)[list(rig.cylinders).index(name)]


def _force(rig, speed, command):
    world, cylinder = _record(rig)
    return driving_force(world, cylinder, 0.05, speed, command)


def test_static_force_is_supply_on_piston_against_atmosphere(exo):
    world, c = _record(exo)
    p_s = exo.supply.pressure
    cylinder = exo.cylinders["knee_l"]
    assert driving_force(world, c, 0.05, 0.0, 1.0) == pytest.approx((p_s - PA) * cylinder.area_1, rel=1e-12)
    assert driving_force(world, c, 0.05, 0.0, -1.0) == pytest.approx(-(p_s - PA) * cylinder.area_2, rel=1e-12)


@given(growth=st.floats(-2e-3, 2e-3), area=st.floats(2e-6, 4e-5), p_s=st.floats(3e5, 2e6))
@settings(max_examples=60)
def test_flow_makes_up_for_growth(growth, area, p_s):
    most = 4 * p_s
    p = steady_pressure(growth, area, p_s, T, T, most, K, R)
    into = flow(area, p_s, T, p, T, K, R) * R * T
    assert p >= 0.999 * most or math.isclose(into, p * growth, rel_tol=1e-3, abs_tol=1e-3 * area * p_s * math.sqrt(R * T))


def test_choked_filling_in_closed_form():
    """Far below the critical ratio P = A_t P_s gamma* sqrt(k R T) / growth."""
    growth, area, p_s = 4e-3, 5e-6, 8e5
    expected = area * p_s * critical_flow_factor(K) * math.sqrt(K * R * T) / growth
    assert expected < 0.5 * p_s
    assert steady_pressure(growth, area, p_s, T, T, 4 * p_s, K, R) == pytest.approx(expected, rel=1e-5)


def test_speed_costs_force_and_back_pressure_grows(exo):
    world, c = _record(exo)
    forces = [driving_force(world, c, 0.05, v, 1.0) for v in (0.0, 0.1, 0.3, 0.6, 1.2)]
    assert forces == sorted(forces, reverse=True) and forces[0] > forces[-1] + 100.0
    assert driving_force(world, c, 0.05, 1e-6, 1.0) == pytest.approx(forces[0], rel=1e-4)


def test_a_larger_valve_loses_less(exo):
    small = replace(exo, cylinders={n: replace(c, valve_area=3e-6) for n, c in exo.cylinders.items()})
    assert _force(small, 0.4, 1.0) < _force(exo, 0.4, 1.0)


def test_friction_of_the_rig_is_taken_off(exo):
    rough = replace(exo, effects=(EffectSetting("coulomb_friction", "knee_l", {"force": 50.0}),))
    for v, opening in ((0.0, 1.0), (0.2, 1.0), (0.2, -1.0), (-0.2, 1.0)):
        loss = _force(exo, v, opening) - _force(rough, v, opening)
        way = opening if v == 0.0 else np.sign(v)
        assert loss == pytest.approx(50.0 * way, abs=0.5)
