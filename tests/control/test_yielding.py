"""How a machine gives way, held against a mass on a spring and a damper, and a foot tip on the ground."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest

from exo_sim.control.machine_dynamics import CONTACTS, PHASES, MachineDynamics
from exo_sim.control.yielding import StrapResponse
from exo_sim.machine.straps import StrapSet
from exo_sim.rig.schema import Ankle

MASS, STIFFNESS, DAMPING, PERIOD = 8.0, 3e4, 200.0, 1.1
#: Five straps hold nine coordinates, each row of one of them; the last row holds nothing.
STRAP = np.zeros((5, 2, 9))
STRAP.reshape(10, 9)[:9] = np.eye(9)


def machine(contact: np.ndarray | None = None, tip: float = 0.0, weight: float = 0.0) -> MachineDynamics:
    n, zero = PHASES, np.zeros
    required = zero((n, 9))
    required[:, 1] = weight
    held = zero((n, len(CONTACTS), 2, 9)) if contact is None else np.broadcast_to(contact, (n, len(CONTACTS), 2, 9))
    place = zero((n, 4, 2))
    place[:, :, 1] = tip
    return MachineDynamics(
        required, held, zero((n, 2, 2, 9)), np.broadcast_to(MASS * np.eye(9), (n, 9, 9)), place, zero((n, 4, 2)), zero((n, 2)),
        zero((n, 2, 2)), np.broadcast_to(STRAP, (n, 5, 2, 9)), zero((n, 5, 2, 2)), zero((n, 7, 6)), MASS,
    )  # fmt: skip


def response(dynamics: MachineDynamics, inputs: np.ndarray) -> StrapResponse:
    class Straps:
        stiffness, damping = np.full((5, 2), STIFFNESS), np.full((5, 2), DAMPING)

    return StrapResponse(dynamics, PERIOD, cast(StrapSet, cast(Any, Straps())), Ankle("free"), inputs)


@pytest.mark.parametrize("harmonic", [1, 6])
def test_a_joint_on_a_strap_is_a_mass_on_a_spring(harmonic: int) -> None:
    turn = 2 * np.pi * harmonic * np.arange(PHASES) / PHASES
    inputs = np.zeros((PHASES, 6, 1))
    inputs[:, 2, 0] = np.cos(turn)  # the left ankle, coordinate 5
    forces, _ = response(machine(), inputs).forces(np.zeros((PHASES, 4)))
    rate = 2 * np.pi * harmonic / PERIOD
    spring = STIFFNESS + 1j * rate * DAMPING
    wanted = np.real(-spring / (spring - MASS * rate**2) * np.exp(1j * turn))
    np.testing.assert_allclose(forces[:, 5, 0], wanted, atol=1e-9)
    np.testing.assert_allclose(np.delete(forces[:, :, 0], 5, axis=1), 0.0, atol=1e-9)


def test_a_tip_on_the_ground_carries_and_one_that_is_lifted_would_be_pulled() -> None:
    contact = np.zeros((4, 2, 9))
    contact[0, :, :2] = np.eye(2)  # the left heel is where the torso is
    low = response(machine(contact, tip=-0.002, weight=100.0), np.zeros((PHASES, 6, 1)))
    heel = np.tile([1.0, 0.0, 0.0, 0.0], (PHASES, 1))
    forces, give = low.forces(heel)
    # weight on two springs, the ground 2 mm too high
    down = (-100.0 + 2e5 * 0.002) / (STIFFNESS + 2e5)
    np.testing.assert_allclose(give[:, 1, -1], down, rtol=1e-9)
    np.testing.assert_allclose(forces[:, 1, -1], -STIFFNESS * down, rtol=1e-9)
    assert not low.pulled(give[:, :, -1])[:, 0].any()
    high = response(machine(contact, tip=0.01, weight=100.0), np.zeros((PHASES, 6, 1)))
    assert high.pulled(high.forces(heel)[1][:, :, -1])[:, 0].all()
