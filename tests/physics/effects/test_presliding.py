"""Known limits of presliding: closed forms and published numbers."""

from __future__ import annotations

import math

import pytest
from physics.sliding import LUGRE, LUGRE_TABLE, contact, slide, steady_resistance

from exo_sim.physics.friction import dry_force


def test_steady_friction_is_lugres_table() -> None:
    joint = contact(**LUGRE, presliding={"stiffness": 1e5, "damping": 100.0})
    for v, force in LUGRE_TABLE:
        assert steady_resistance(joint, v) == pytest.approx(force, abs=2e-9)


def test_stuck_contact_is_a_spring_of_its_stiffness() -> None:
    joint = contact(coulomb_friction={"force": 15.0}, presliding={"stiffness": 2e4, "damping": 400.0})
    found = slide(joint, 5.0, 0.0, lambda t, q: 1.5 * min(t / 0.2, 1.0), 1.0, 1e-4)
    # LuGre gives 1/(1 - F/Fc) more than the spring alone at slow loading: x = -(Fc/s0) log(1 - F/Fc)
    assert found[-1, 0] == pytest.approx(-15.0 / 2e4 * math.log(1 - 0.1), rel=5e-3)


def test_a_contact_that_slides_is_not_damped() -> None:
    """Turning round at speed takes no more than the dry level, however damped the contact is while it sticks."""
    joint = contact(coulomb_friction={"force": 15.0}, presliding={"stiffness": 2e4, "damping": 400.0})[0]
    for v in (0.1, 0.3, 1.0):
        assert abs(dry_force(joint, -15.0 / 2e4, v, 15.0)) <= 15.0 * (1.0 + 1e-6)
    assert dry_force(joint, 0.0, 1e-4, 15.0) == pytest.approx(400.0 * 1e-4, rel=1e-3)
