"""What resists a motion: a contact that holds, slides at its level, and never pushes back harder than a step can bear."""

from __future__ import annotations

import math
from typing import Any

import pytest
from physics.sliding import contact

from exo_sim.physics.conditions import Motion
from exo_sim.physics.friction import STUCK_TIME, bristle_stiffness, dry_force, joint_dry_level, joint_resistance, move_bristle


def part(**effects: dict[str, float]) -> Any:
    joint = contact(**effects)
    joint["effective_mass"], joint["step"] = 5.0, 1e-3
    return joint[0]


def test_a_bristle_bends_with_the_motion_until_the_level_and_slides_there() -> None:
    c, level = part(coulomb_friction={"force": 20.0}), 20.0
    stiffness = bristle_stiffness(c, level)
    assert stiffness == pytest.approx(min(20.0 / 1e-5, 5.0 / STUCK_TIME**2))
    assert move_bristle(c, 0.0, 1e-4, level, 1e-3) == pytest.approx(1e-7)
    assert move_bristle(c, 0.0, 1.0, level, 1.0) == pytest.approx(level / stiffness)
    assert dry_force(c, level / stiffness, 1.0, level) == pytest.approx(level)


def test_without_a_level_there_is_neither_bristle_nor_force() -> None:
    c = part()
    assert move_bristle(c, 3e-6, 0.1, 0.0, 1e-3) == 0.0 and dry_force(c, 3e-6, 0.1, 0.0) == 0.0


def test_a_contact_that_sticks_is_critically_damped_at_most() -> None:
    c = part(coulomb_friction={"force": 1e4})
    stiffness = bristle_stiffness(c, 1e4)
    assert dry_force(c, 0.0, 1e-3, 1e4) == pytest.approx(math.sqrt(stiffness * 5.0) * 1e-3)


def test_damping_never_throws_a_part_back_within_a_step() -> None:
    c = part(viscous_friction={"coefficient": 1e9})
    assert joint_resistance(c, Motion(0.0, 0.2, 0.0, 0.0, 0.0)) == pytest.approx(0.5 * 5.0 / 1e-3 * 0.2)
    gentle = part(viscous_friction={"coefficient": 3.0})
    assert joint_resistance(gentle, Motion(0.0, 0.2, 0.0, 0.0, 0.0)) == pytest.approx(0.6)


def test_the_level_of_a_joint_is_that_of_its_effects() -> None:
    c = part(coulomb_friction={"force": 15.0}, stribeck_friction={"breakaway": 25.0, "velocity": 0.02})
    assert joint_dry_level(c, Motion(0.0, 0.0, 0.0, 0.0, 0.0)) == pytest.approx(25.0)
    assert joint_dry_level(c, Motion(0.0, 5.0, 0.0, 0.0, 0.0)) == pytest.approx(15.0)
