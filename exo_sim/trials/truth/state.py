"""The state vector of the true machine: where each number stands, what is logged of it, and the machine at rest."""

from __future__ import annotations

import numpy as np

from exo_sim.trials.truth.compiled import kernel

# places in the state vector
XP, VP, XL, VL, M1, T1, M2, T2, TANK, MX, TX, ML1, TL1, ML2, TL2, W1, W2, Q1, Q2, SPOOL, SPOOL_V, REGULATED = range(22)
STATES = 22
#: Columns of the log: time, position of the load, its velocity, both pressures as the sensors' place sees them, at the
#: chamber and at the valve end of the hose, temperatures, supply, exhaust, rod force, command, piston position.
LOG = ("time", "position", "velocity", "pressure_1", "pressure_2", "line_1", "line_2", "temperature_1", "temperature_2",
       "supply", "exhaust", "force", "command", "piston")  # fmt: skip


@kernel
def at_rest(x, p1, p2, p):
    """Return the state at rest at piston position x with both chambers at ambient temperature, shape (STATES,)."""
    y = np.zeros(STATES)
    temperature = p.ambient_temperature
    rt = p.gas_constant * temperature
    y[XP] = x
    y[XL] = x
    y[M1] = p1 * (p.dead_1 + p.area_1 * x) / rt
    y[M2] = p2 * (p.dead_2 + p.area_2 * (p.stroke - x)) / rt
    y[T1] = y[T2] = y[TX] = y[TL1] = y[TL2] = y[W1] = y[W2] = temperature
    y[TANK] = p.supply_pressure
    y[REGULATED] = p.supply_pressure
    y[MX] = p.ambient_pressure * p.exhaust_volume / rt
    y[ML1] = p1 * p.line_volume / rt
    y[ML2] = p2 * p.line_volume / rt
    return y
