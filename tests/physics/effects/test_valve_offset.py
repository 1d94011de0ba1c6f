"""Known limits of valve offset: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
from physics.stepping import hold, tank

from exo_sim.physics import state


def test_zero_command_is_the_papers_valve_at_the_shift() -> None:
    gas, paper = tank(5e-5, 5e-6, dt=1e-3), tank(5e-5, 5e-6, dt=1e-3)
    gas.cylinders["valve_offset"]["shift"] = 0.25
    for each, command in ((gas, 0.0), (paper, 0.25)):
        each.fill(np.zeros(1), 3e5, 3e5)
        each.memory[0, state.SPOOL] = command
        hold(each, command, 0.05)
    assert (gas.pressures(np.zeros(1)) == paper.pressures(np.zeros(1))).all()
    assert gas.pressures(np.zeros(1))[0, 0] > 3e5 > gas.pressures(np.zeros(1))[0, 1]
