"""All effects together add up: the total at a part is the sum of what each of them adds alone."""

from __future__ import annotations

import pytest
from physics.sliding import contact

from exo_sim.physics import summed_effects
from exo_sim.physics.conditions import Motion
from exo_sim.physics.pneumatics import paper_cylinder

MOVING = Motion(0.02, 0.3, 0.0, 2e5, 1e5)


def test_dry_friction_of_a_piston_is_the_sum_of_its_parts() -> None:
    alone = []
    both = paper_cylinder(0.032, 0.012, 0.1, 5e-6)
    for name, numbers in (("coulomb_friction", {"force": 7.0}), ("pressure_dependent_friction", {"coefficient": 2e-5})):
        one = paper_cylinder(0.032, 0.012, 0.1, 5e-6)
        for key, value in numbers.items():
            one[name][key] = both[name][key] = value
        alone.append(summed_effects.piston_dry_friction(one[0], MOVING))
    assert alone == pytest.approx([7.0, 6.0])
    assert summed_effects.piston_dry_friction(both[0], MOVING) == pytest.approx(13.0)


def test_damping_and_springs_of_a_joint_are_theirs_and_nothing_without() -> None:
    joint = contact(viscous_friction={"coefficient": 4.0}, quadratic_drag={"coefficient": 10.0}, return_spring={"stiffness": 50.0})
    assert summed_effects.joint_damping(joint[0], MOVING) == pytest.approx(4.0 + 10.0 * 0.3)
    assert summed_effects.joint_spring_force(joint[0], MOVING) == pytest.approx(50.0 * 0.02)
    assert summed_effects.joint_damping(contact()[0], MOVING) == summed_effects.joint_spring_force(contact()[0], MOVING) == 0.0


def test_the_excess_of_stribeck_comes_on_top_of_the_level_so_far() -> None:
    joint = contact(stribeck_friction={"breakaway": 25.0, "velocity": 0.02})
    at_rest = Motion(0.0, 0.0, 0.0, 0.0, 0.0)
    assert summed_effects.joint_with_excess(joint[0], 15.0, at_rest) == pytest.approx(25.0)
    assert summed_effects.joint_with_excess(contact()[0], 15.0, at_rest) == 15.0
