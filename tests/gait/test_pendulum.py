"""The linear inverted pendulum over a cycle: its weight and inertia pass through the centre of pressure."""

import numpy as np

from exo_sim.gait.motion import derivatives
from exo_sim.gait.pendulum import above
from exo_sim.machine.anthropometry import GRAVITY


def test_the_pendulum_stands_on_its_centre_of_pressure():
    phase = np.arange(512) / 512
    centre = 0.3 + 0.1 * np.sign(np.sin(2 * np.pi * phase)) * np.abs(np.sin(2 * np.pi * phase)) ** 3
    x = above(centre, 0.95, 1.1)
    _, curvature = derivatives(x[:, None])
    np.testing.assert_allclose(x - 0.95 / GRAVITY * curvature[:, 0] / 1.1**2, centre, atol=1e-9)
    assert np.ptp(x) < np.ptp(centre)
