"""Joint torques demanded: statics by hand, and laws set against each other."""

import numpy as np
import pytest

from exo_sim.control.demand import demand, limit
from exo_sim.control.machine_dynamics import PHASES, along
from exo_sim.errors import ScenarioError
from exo_sim.gait import scenario
from exo_sim.machine.person import Person
from exo_sim.machine.straps import fasten
from exo_sim.machine.worn_model import build
from exo_sim.rig import Ankle


@pytest.fixture(scope="module")
def standing(repository):
    person = Person()
    model = build(repository / "assets" / "exo.xml", person, 34.0, Ankle("powered"))
    motion, straps = scenario.motion("stand", person, 1.0), fasten(model, person)
    return motion, straps, along(model, motion, person, straps)


def test_standing_needs_the_weight_and_nothing_sideways(standing):
    _, _, dynamics = standing
    assert dynamics.mass == pytest.approx(54.0)
    np.testing.assert_allclose(dynamics.required[:, 0], 0.0, atol=1e-9)
    np.testing.assert_allclose(dynamics.required[:, 1], 54.0 * 9.81, rtol=1e-6)


def test_virtual_support_by_hand(standing):
    """Half the weight through the centre of pressure, aimed at the mass centre, times its lever at the ankle."""
    motion, straps, dynamics = standing
    torque = demand("virtual_support", dynamics, motion, straps, Ankle("powered", torque=500.0))
    aim = dynamics.mass_centre[0] - dynamics.pressure_point[0, 0]
    force = 0.5 * 54.0 * 9.81 * np.array([aim[0] / aim[1], 1.0])
    ankle = np.array([0.0, 0.070])  # the ankle stands over x = 0
    lever = dynamics.pressure_point[0, 0] - ankle
    about_minus_y = lever[0] * force[1] - lever[1] * force[0]
    np.testing.assert_allclose(torque[:, 2], -about_minus_y, rtol=1e-6)


def test_inverse_dynamics_leaves_no_moment_on_the_torso(standing):
    motion, straps, dynamics = standing
    torque = demand("inverse_dynamics", dynamics, motion, straps, Ankle("powered", torque=500.0))[:: 512 // PHASES]
    # put back: required = torque + ground + a horizontal force at the middle of the harness
    left = dynamics.required.copy()
    left[:, 3:] -= torque
    vertical = left[:, 1]
    pushes = dynamics.pressure[:, 0] * 0.5 + dynamics.pressure[:, 1] * 0.5
    harness = dynamics.strap[0, :2, :, :].mean(axis=0)
    direction = dynamics.strap_direction[0, 0]
    pull = direction[:, 0] @ harness
    basis = np.stack([pushes[0, 0], pushes[0, 1], pull], axis=1)
    found, residual, *_ = np.linalg.lstsq(basis, left[0], rcond=None)
    assert residual.sum() < 1e-6
    assert found[1] == pytest.approx(vertical[0], rel=1e-6)


def test_an_unpowered_ankle_is_asked_for_nothing(standing):
    motion, straps, dynamics = standing
    for mode in ("free", "sprung"):
        assert np.all(demand("virtual_support", dynamics, motion, straps, Ankle(mode))[:, [2, 5]] == 0.0)
    assert limit(np.full((2, 6), 99.0), Ankle("powered", torque=30.0))[0, 2] == 30.0
    with pytest.raises(ScenarioError, match="virtual_support"):
        demand("virtual_suport", dynamics, motion, straps, Ankle())
