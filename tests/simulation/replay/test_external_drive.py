"""Who moves a joint is told by power: friction takes it, a person or a test machine gives it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from exo_sim.simulation.replay.external_drive import DRIVEN_SHARE, external_power

Array = NDArray[np.float64]
TIME: Array = np.asarray(np.arange(4000) * 1e-3, dtype=np.float64)
SPEED: Array = 0.3 * np.cos(2.0 * np.pi * TIME)
DRIVE: Array = 40.0 * np.sign(SPEED) + 5.0 * np.sin(6.0 * np.pi * TIME)


@pytest.mark.parametrize("lost", [0.0 * SPEED, 8.0 * np.sign(SPEED), 20.0 * SPEED])
def test_friction_and_damping_are_no_drive(lost: Array) -> None:
    assert external_power(TIME, DRIVE - lost, DRIVE, SPEED) == ""


def test_a_constant_force_is_a_sensor_s_zero() -> None:
    assert external_power(TIME, DRIVE + 15.0, DRIVE, SPEED) == ""


def test_a_hand_that_pushes_along_is_a_drive() -> None:
    """Half as much again as what is known: a third of all power."""
    says = external_power(TIME, DRIVE + 20.0 * np.sign(SPEED), DRIVE, SPEED)
    share = float(says.split(" put in ")[1].split(" %")[0]) / 100.0
    assert share == pytest.approx(20.0 / 60.0, abs=0.02) and share > DRIVEN_SHARE


def test_a_joint_that_nothing_moves_is_not_driven() -> None:
    assert external_power(TIME, 0.0 * TIME, 0.0 * TIME, 0.0 * TIME) == ""
