"""Regimes of a chamber: what its valve does, choked or not, moving or not."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.discrepancy.trace import near_reversal
from exo_sim.diagnosis.policy.regimes import AT_REST, AT_REST_SHARE, CLOSED, SMALL_COMMAND
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs
from exo_sim.physics.nozzle import critical_ratio


def regimes(inputs: GasInputs, side: int, k: float) -> dict[str, NDArray[np.bool_]]:
    """Return the regimes of one chamber by name, shape (n,) each; `k` is the heat capacity ratio."""
    run, supply, exhaust = inputs.run, inputs.supply, inputs.exhaust
    pressure = run.pressure[side]
    assert pressure is not None
    command = run.towards(side)
    filling, venting = command > CLOSED, command < -CLOSED
    closed = ~filling & ~venting
    limit = critical_ratio(k)
    with np.errstate(invalid="ignore", divide="ignore"):
        choked_in = pressure < limit * supply
        choked_out = exhaust < limit * pressure
        above = pressure > supply
    speed = np.zeros(len(run.time)) if run.speed is None else run.speed
    moving = (
        np.abs(speed) > max(AT_REST, AT_REST_SHARE * float(np.nanmax(np.abs(speed))))
        if run.speed is not None
        else np.zeros(len(speed), bool)
    )
    return {
        "valve closed, piston at rest": closed & ~moving,
        "valve closed, piston moving": closed & moving,
        "valve closed": closed,
        "filling, choked": filling & choked_in & ~above,
        "filling, subsonic": filling & ~choked_in & ~above,
        "filling": filling,
        "chamber above supply": above & filling,
        "venting, choked": venting & choked_out,
        "venting, subsonic": venting & ~choked_out,
        "venting": venting,
        "small commands": closed | (np.abs(command) < SMALL_COMMAND),
        "piston moving": moving,
        "piston at rest": ~moving,
        "command near zero crossing": near_reversal(run.time, command),
    }
