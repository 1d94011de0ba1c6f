"""How warm the gas is where a recording begins: no sensor says it, and a machine that was just at work has it off the room's temperature.

Gas that was filled in or let out a moment ago is tens of kelvin away and settles within seconds, with a change of pressure that a leak or
a wall would make as well.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.nominal_numbers import INITIAL_TEMPERATURE
from exo_sim.diagnosis.policy import priors
from exo_sim.diagnosis.policy.recordings import FEWEST_OF_CHANNEL, QUIET, QUIET_DRIFT, QUIET_START, STILL_LENGTH


def initial_temperatures(runs: Sequence[CylinderRun]) -> tuple[FreeParameter, ...]:
    """Return, for every run that does not begin quietly, by how much the gas of each measured chamber is then off the surroundings' [K]."""
    spread, most = priors.INITIAL_WARMTH, priors.MOST_INITIAL_WARMTH
    return tuple(
        FreeParameter(
            INITIAL_TEMPERATURE, run.cylinder, _name(run, side), "K", Target.SENSOR, spread, -most, most, (0.0, spread)
        )  # fmt: skip
        for run in runs
        if not begins_quietly(run)
        for side in (1, 2)
        if run.pressure[side - 1] is not None
    )


def warmth(sensors: Mapping[str, float], run: CylinderRun) -> tuple[float, float]:
    """Return by how much the gas of both chambers is warmer than the surroundings where a run begins [K].

    Args:
        sensors: As of `PlantParameters`.
        run: One that begins elsewhere than the one that was fitted, as a part of it may, begins at the surroundings' temperature.
    """
    return sensors.get(_name(run, 1), 0.0), sensors.get(_name(run, 2), 0.0)


def begins_quietly(run: CylinderRun) -> bool:
    """Return whether neither the piston nor a measured pressure changes in the first second: its gas then is as warm as its walls.

    Nor before it: of a vessel that was held under pressure until it was left to decay, the gas has settled as well.
    """
    if run.settled:
        return True
    first = run.time < run.time[0] + QUIET_START
    if first.sum() < 2 * FEWEST_OF_CHANNEL:
        return False
    if run.length is not None and np.ptp(run.length[first]) > STILL_LENGTH:
        return False
    for pressure, noise in zip(run.pressure, run.noise, strict=True):
        if pressure is None:
            continue
        values = pressure[first]
        halves = [half[np.isfinite(half)] for half in np.array_split(values, 2)]
        if min(half.size for half in halves) < FEWEST_OF_CHANNEL:
            return False
        level = float(np.mean(halves[0]))
        drift = abs(float(np.mean(halves[1])) - level)
        if drift > max(QUIET_DRIFT * level, QUIET * noise * float(np.sqrt(sum(1.0 / half.size for half in halves)))):
            return False
    return True


def _name(run: CylinderRun, side: int) -> str:
    return f"{INITIAL_TEMPERATURE}.{run.recording}.{float(run.time[0]):g}.chamber_{side}"
