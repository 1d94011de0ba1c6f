"""The force that resists a piston along a measured path, in closed form for the laws that have one."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import motion_runs

from exo_sim.diagnosis.subsystems.motion.resistance import resistance_along

TIME, POSITION, VELOCITY = motion_runs.TIME, motion_runs.POSITION, motion_runs.VELOCITY


def along(**settings: dict[str, float]) -> np.ndarray:
    """Return the resistance with these effects on, shape (n,)."""
    cylinder = motion_runs.plant().cylinder.copy()
    for name, entries in settings.items():
        for key, value in entries.items():
            cylinder[name][key] = value
    out = np.empty(TIME.size)
    resistance_along(cylinder[0], TIME, POSITION, VELOCITY, np.zeros((TIME.size, 2)), out)
    return out


def test_nothing_resists_a_plain_piston() -> None:
    assert not along().any()


def test_viscous_friction_is_proportional_to_speed() -> None:
    np.testing.assert_allclose(along(viscous_friction={"coefficient": 40.0}), 40.0 * VELOCITY, rtol=1e-12)


def test_drag_grows_with_the_square_of_speed() -> None:
    np.testing.assert_allclose(along(quadratic_drag={"coefficient": 90.0}), 90.0 * VELOCITY * np.abs(VELOCITY), rtol=1e-12)


def test_dry_friction_has_its_level_beside_the_turns() -> None:
    found = along(coulomb_friction={"force": 12.0})
    fast = (np.abs(VELOCITY) > 0.05) & (TIME > 0.0)  # a bristle begins unbent
    np.testing.assert_allclose(found[fast], 12.0 * np.sign(VELOCITY[fast]), rtol=1e-3)
    assert np.abs(found).max() <= 12.0 * (1.0 + 1e-9)


def test_resistances_add_up() -> None:
    both = along(viscous_friction={"coefficient": 40.0}, quadratic_drag={"coefficient": 90.0})
    apart = along(viscous_friction={"coefficient": 40.0}) + along(quadratic_drag={"coefficient": 90.0})
    np.testing.assert_allclose(both, apart, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("stiffness", [5e5, 5e6])
def test_damped_bristles_resist_a_turn_by_what_they_move_however_few_samples_that_takes(stiffness: float) -> None:
    """From one end of their travel to the other: 2 F d/k in newton seconds, where the motion is slow enough for all of the damping."""
    level, damping = 12.0, 400.0
    time = np.arange(1001) * 1e-3
    velocity = 0.02 * (0.5 - time)
    position = 0.02 * (0.5 * time - 0.5 * time**2)
    cylinder = motion_runs.plant().cylinder.copy()
    cylinder["coulomb_friction"]["force"], cylinder["presliding"]["stiffness"] = level, stiffness
    found = {}
    for of in (0.0, damping):
        cylinder["presliding"]["damping"], found[of] = of, np.empty(time.size)
        resistance_along(cylinder[0], time, position, velocity, np.zeros((time.size, 2)), found[of])
    turn = slice(300, None)  # they bend at the start, too
    more = np.trapezoid((found[damping] - found[0.0])[turn], time[turn])
    assert more == pytest.approx(-2.0 * level * damping / stiffness, rel=0.05)
