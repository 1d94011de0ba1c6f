"""Known limits of spool rate limit: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.stepping import hold, tank

from exo_sim.physics import state


def test_spool_moves_at_its_rate_and_no_faster() -> None:
    gas = tank(5e-5, 5e-6, dt=1e-3)
    gas.cylinders["spool_rate_limit"]["rate"] = 40.0
    gas.fill(np.zeros(1), 2e5, 2e5)
    hold(gas, 1.0, 0.01)
    assert gas.memory[0, state.SPOOL] == pytest.approx(0.4, rel=1e-12)
    hold(gas, 1.0, 0.03)
    assert gas.memory[0, state.SPOOL] == 1.0
