"""The force that resists a piston along a measured path, in closed form for the laws that have one."""

from __future__ import annotations

import numpy as np
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
