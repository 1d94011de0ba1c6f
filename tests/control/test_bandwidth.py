"""The paper's claim in small: the controller that knows the gas follows faster."""

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.control.bandwidth import bandwidth, response
from exo_sim.control.valve_control import MODEL, PI


def test_bandwidth_of_a_known_lag():
    frequency = np.geomspace(1, 100, 60)
    assert bandwidth(frequency, (1 / (1 + 1j * frequency / 20.0)).astype(complex)) == pytest.approx(20.0, rel=1e-2)
    delay = np.exp(-2j * np.pi * frequency * 0.01)
    assert bandwidth(frequency, delay) == pytest.approx(25.0, rel=1e-2)
    assert np.isnan(bandwidth(frequency, np.ones(60, dtype=complex)))


def test_the_model_follows_where_pi_lags(repository):
    rig = rigs.read(repository / "assets" / "exo_250_psi.toml")
    at = np.array([30.0])
    plain, model = (response(rig, "hip_r", code, at, 100.0)[0] for code in (PI, MODEL))
    assert abs(model - 1) < 0.15
    assert abs(plain - 1) > 0.4
