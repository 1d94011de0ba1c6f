"""An error of the phase is found in strap forces, and told from torques that are others."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray

from exo_sim.control.least_load import LeastLoad
from exo_sim.control.machine_dynamics import PHASES
from exo_sim.control.phase_correction import PhaseCorrection
from exo_sim.gait.motion import SAMPLES

Array = NDArray[np.float64]
PER_TORQUE = np.array([[0.5, -0.2], [0.1, 0.3]])


def torque(phase: Array) -> Array:
    turn = 2 * np.pi * phase
    return np.stack([30.0 * np.cos(turn), 10.0 * np.sin(2 * turn)], axis=1)


def usual(phase: Array) -> Array:
    turn = 2 * np.pi * phase
    return np.stack([80.0 * np.sin(turn) + 20.0, 40.0 * np.cos(2 * turn)], axis=1)


class Plan:
    """Two torques, and straps that answer them at once."""

    best = np.zeros(1)
    driven = (0, 1)

    def table(self, coefficients: Array) -> Array:
        return torque(np.arange(SAMPLES) / SAMPLES)

    def strap_forces(self, torques: Array) -> Array:
        return torques @ PER_TORQUE.T


def correction() -> PhaseCorrection:
    return PhaseCorrection(cast(LeastLoad, cast(Any, Plan())), usual(np.arange(PHASES) / PHASES))


def shown(estimated: Array, late: float, more: float = 0.0) -> tuple[Array, Array]:
    """Return strap forces and torques at estimated phases that are late; torques beyond those of the plan come on both joints."""
    asked = torque(estimated) + more
    true = estimated + late
    return usual(true) + (asked - torque(true)) @ PER_TORQUE.T, asked


@pytest.mark.parametrize("late", [-0.03, 0.0, 0.02])
@pytest.mark.parametrize("more", [0.0, 8.0])
def test_a_late_phase_is_found_whatever_the_torques(late: float, more: float) -> None:
    assert correction().late(*shown(np.arange(PHASES) / PHASES, late, more)) == pytest.approx(late, abs=0.1 * abs(late) + 1e-12)


def test_the_phase_is_right_after_some_strides_and_wrong_again_once_forgotten() -> None:
    corrected, step = correction(), 1.0 / (4 * PHASES)
    for k in range(30 * 4 * PHASES):
        phase = k * step + corrected.added
        forces, torques = shown(np.array([phase]), 0.03 - corrected.added)
        corrected.take(phase, forces[0], torques[0])
    assert corrected.added == pytest.approx(0.03, abs=1e-3)
    corrected.forget()
    assert corrected.added == 0.0


def test_no_more_than_a_tenth_of_a_stride_is_corrected() -> None:
    corrected = correction()
    for k in range(40 * PHASES):
        forces, torques = shown(np.array([k / PHASES]), 0.1)
        corrected.take(k / PHASES, forces[0], torques[0])
    assert corrected.added == pytest.approx(0.1)
