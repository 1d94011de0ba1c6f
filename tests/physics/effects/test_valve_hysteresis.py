"""Known limits of valve hysteresis: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.stepping import hold, tank

from exo_sim.physics import state


def test_loop_is_as_wide_as_its_width() -> None:
    gas = tank(5e-5, 5e-6, dt=1e-3)
    gas.cylinders["valve_hysteresis"]["width"] = 0.06
    gas.fill(np.zeros(1), 2e5, 2e5)
    spools = []
    for command in (0.5, 0.3, -0.5, 0.3):
        hold(gas, command, 0.002)
        spools.append(gas.memory[0, state.SPOOL])
    assert spools == pytest.approx([0.47, 0.33, -0.47, 0.27], abs=1e-15)
    assert spools[1] - spools[3] == pytest.approx(0.06)
