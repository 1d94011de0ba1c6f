"""The books: what gas and energy went in and out, against what is there now."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics import state

#: Share of what was there below which what passed is no measure: what is there is only known to its own rounding.
_SLIGHT = 1e-6


@dataclass
class Books:
    """What went in and out, against what is there now.

    Attributes:
        mass_residual: Gas unaccounted for, relative to what passed through, or to a millionth of what was there where less passed.
        energy_residual: Energy unaccounted for, relative alike.
        drawn: Gas drawn from the supply by each cylinder [kg], shape (n,).
        heat: Heat into the gas of each cylinder [J], shape (n,).
        work: Work of the gas on each piston [J], shape (n,).
        recovered: Gas that the recovery tank gained [kg]; 0 where there is none.
    """

    mass_residual: float
    energy_residual: float
    drawn: NDArray[np.float64]
    heat: NDArray[np.float64]
    work: NDArray[np.float64]
    recovered: float = 0.0


def balance(world: NDArray[np.void], cylinders: int, change: NDArray[np.float64], start: NDArray[np.float64] | None = None) -> Books:
    """Return the books of a machine.

    Args:
        world: Record WORLD, shape (1,).
        cylinders: How many there are.
        change: Of the integrated state since the books were opened, shape (integrated_size(cylinders),).
        start: That state itself when they were opened; None measures by what passed alone.
    """
    inside = cylinders * state.INTEGRATED
    y, shared = change[:inside].reshape(cylinders, state.INTEGRATED), change[inside:]
    mass = [state.MASS_1, state.MASS_2, state.HOSE_MASS_1, state.HOSE_MASS_2, state.MIDDLE_MASS_1, state.MIDDLE_MASS_2]
    energy = [state.ENERGY_1, state.ENERGY_2, state.HOSE_ENERGY_1, state.HOSE_ENERGY_2, state.MIDDLE_ENERGY_1, state.MIDDLE_ENERGY_2]
    drawn, let_out, leaked = y[:, state.DRAWN], y[:, state.EXHAUSTED], y[:, state.LEAKED]
    h_drawn, h_let_out, h_leaked = y[:, state.DRAWN_ENTHALPY], y[:, state.EXHAUSTED_ENTHALPY], y[:, state.LEAKED_ENTHALPY]
    missing = y[:, mass].sum(1) - drawn + let_out + leaked
    lost = y[:, energy].sum(1) - h_drawn + h_let_out + h_leaked + y[:, state.WORK] - y[:, state.HEAT]
    if world["tank_volume"][0] > 0.0:  # what one chamber gives another takes, or the tank keeps it
        missing, lost = np.array([missing.sum() + shared[state.TANK_MASS]]), np.array([lost.sum() + shared[state.TANK_ENERGY]])
    off, off_energy = np.abs(missing).sum(), np.abs(lost).sum()
    if world["supply_droop"]["volume"][0] > 0.0:
        off += abs(shared[state.SUPPLY_MASS] - shared[state.FED] + drawn.sum())
        off_energy += abs(shared[state.SUPPLY_ENERGY] - shared[state.FED_ENTHALPY] + h_drawn.sum())
    if world["exhaust_back_pressure"]["area"][0] > 0.0:
        off += abs(shared[state.EXHAUST_MASS] + shared[state.RELEASED] - let_out.sum())
        off_energy += abs(shared[state.EXHAUST_ENERGY] + shared[state.RELEASED_ENTHALPY] - h_let_out.sum())
    passed = np.abs([drawn, let_out, leaked]).sum()
    carried = np.abs([h_drawn, h_let_out, h_leaked, y[:, state.WORK], y[:, state.HEAT]]).sum()
    if start is not None:
        first, first_shared = start[:inside].reshape(cylinders, state.INTEGRATED), start[inside:]
        masses = [state.SUPPLY_MASS, state.EXHAUST_MASS, state.TANK_MASS]
        energies = [state.SUPPLY_ENERGY, state.EXHAUST_ENERGY, state.TANK_ENERGY]
        passed = max(passed, _SLIGHT * (first[:, mass].sum() + first_shared[masses].sum()))
        carried = max(carried, _SLIGHT * (first[:, energy].sum() + first_shared[energies].sum()))
    return Books(
        float(off / passed) if passed > 0.0 else float(off),
        float(off_energy / carried) if carried > 0.0 else float(off_energy),
        drawn.copy(),
        y[:, state.HEAT].copy(),
        y[:, state.WORK].copy(),
        float(shared[state.TANK_MASS]),
    )
