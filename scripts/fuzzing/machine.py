"""A rig's machine driven hard for a moment, and its books closed: the plug-in under any numbers that a rig file may hold."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

#: What the gas's books may leave open, relative to what passed through.
BOOKS = 1e-8
_STEPS = 300


def drive(words: list[str]) -> int:
    """Drive the machine of the rig `words[1]`; return 0, or 2 or 5 where it was refused in one line.

    Raises:
        AssertionError: state or forces are no numbers, pressures not above 0, or the books do not close.
    """
    import mujoco

    from exo_sim import rig as rigs
    from exo_sim.errors import ExoSimError, one_line
    from exo_sim.machine.rig_model import load
    from exo_sim.simulation.plugin import PneumaticPlugin

    try:
        rig = rigs.read(Path(words[1]))
        model = load(rig)
        data, plugin = mujoco.MjData(model), PneumaticPlugin(model, rig)
        plugin.reset(data)
        for i in range(_STEPS):
            plugin.command[:] = math.sin(0.21 * i) if i % 90 < 60 else (-1.0) ** (i // 45)
            plugin.step(data)
            if data.warning.number.any():
                print("exo-sim: MuJoCo warns of this motion", file=sys.stderr)
                return 5
    except ExoSimError as error:
        print(f"exo-sim: {one_line(str(error))}", file=sys.stderr)
        return error.exit_status
    pressures, books = plugin.pressures(), plugin.books()
    assert np.isfinite(plugin.pneumatics.vector).all() and np.isfinite(plugin.force).all(), "a state that is no number"
    assert (pressures > 0.0).all(), f"pressures {pressures.tolist()}"
    assert books.mass_residual < BOOKS, f"mass books leave {books.mass_residual:g} open"
    assert books.energy_residual < BOOKS, f"energy books leave {books.energy_residual:g} open"
    return 0
