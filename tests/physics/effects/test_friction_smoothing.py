"""Known limits of friction smoothing: closed forms and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from physics.sliding import contact, nothing, slide

from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world


def test_creeps_under_a_push_at_the_speed_where_they_balance() -> None:
    """F = Fc tanh(v/v0): a push of half of Coulomb's friction ends at v0 artanh(1/2)."""
    for velocity, dt in ((1e-3, 2.5e-4), (5e-3, 1e-3), (2e-2, 1e-3), (2e-2, 2.5e-4)):
        joint = contact(coulomb_friction={"force": 20.0}, friction_smoothing={"velocity": velocity})
        found = slide(joint, 5.0, 0.0, lambda t, q: 10.0, 1.0, dt)
        rested = found[len(found) // 2 :]
        speed = (rested[-1, 0] - rested[0, 0]) / (dt * (len(rested) - 1))
        assert speed == pytest.approx(velocity * math.atanh(0.5), rel=1e-6)


def test_sticks_where_the_time_step_does_not_resolve_its_slope() -> None:
    found = slide(contact(coulomb_friction={"force": 20.0}, friction_smoothing={"velocity": 1e-5}), 5.0, 0.0, lambda t, q: 10.0, 5.0, 1e-3)
    assert abs(found[-1, 0]) < 1e-3 and np.abs(found[:, 1]).max() < 1e-2


def test_slides_like_sharp_friction_far_above_its_velocity() -> None:
    found = slide(contact(coulomb_friction={"force": 20.0}, friction_smoothing={"velocity": 1e-4}), 10.0, 0.3, nothing, 1.0, 1e-4)
    assert found[-1, 0] == pytest.approx(10.0 * 0.3**2 / (2 * 20.0), rel=2e-3)


def test_creeps_behind_a_soft_mount_as_without_one() -> None:
    """Fc tanh(v/v0) is reached as (Fc/v0)/stiffness goes by, 80 ms."""
    cylinder = paper_cylinder(0.032, 0.012, 0.1, 5e-6, 100.0, 100.0)
    cylinder["coulomb_friction"]["force"], cylinder["friction_smoothing"]["velocity"] = 40.0, 5e-3
    cylinder["transmission_compliance"]["stiffness"] = 1e5
    gas = Pneumatics(paper_world(), cylinder, dt=1e-3)
    a_1, a_2 = cylinder["area_1"][0], cylinder["area_2"][0]
    p_2 = 5e5 * a_1 / a_2 - 101325.0 * (a_1 - a_2) / a_2  # as large a push both ways
    gas.fill(np.array([0.05]), 5e5, p_2)
    gas.settle_transmission(np.array([0.05]))
    for v in (2e-3, 1e-2, -1e-2):
        x = 0.05
        for _ in range(1500):
            gas.advance(np.array([x]), np.array([x + v * 1e-3]), np.zeros(1))
            x += v * 1e-3
        resisted = -40.0 * math.tanh(v / 5e-3)
        assert gas.forces(np.array([x]), np.array([v]))[0] == pytest.approx(resisted, rel=2e-3)
