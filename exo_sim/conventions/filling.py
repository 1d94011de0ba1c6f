"""Whether a recording is quick enough for its gas: how many samples it has in the time in which an open valve fills a chamber."""

from __future__ import annotations

import numpy as np

from exo_sim.physics.nozzle import flow
from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.table import Recording
from exo_sim.rig import Cylinder, Rig

#: Samples in a filling below which a recording is called slow for its gas, and those that are asked for. Benches of the proving ground with
#: one effect, fillings of 66 to 96 ms, thinned from 1 kHz: with 19 and 21 samples the name was found both times, with 13 and 17 once, with
#: 7 to 10 once of four times; at 1 kHz every time.
SLOW, ENOUGH = 18.0, 45.0
#: Of a recording that is no slower [Hz] no more is asked: what a valve is told by a loop at its rate is all in it.
QUICK = 500.0


def filling_time(cylinder: Cylinder, rig: Rig) -> float:
    """Return how long the whole valve takes to fill the quicker chamber, half of its stroke open, from the atmosphere to the supply [s].

    Of a choked flow; infinite where nothing flows.
    """
    temperature, k, r = rig.supply.temperature, rig.heat_capacity_ratio, rig.specific_gas_constant
    outside, inside = rig.environment.pressure, rig.supply.pressure
    mass_flow = float(flow(cylinder.valve_area, inside, temperature, outside, temperature, k, r)) if cylinder.valve_area > 0.0 else 0.0
    if mass_flow <= 0.0:
        return float("inf")
    sides = ((cylinder.dead_volume_1, cylinder.area_1), (cylinder.dead_volume_2, cylinder.area_2))
    volume = min(dead + 0.5 * area * cylinder.stroke for dead, area in (sides[:1] if cylinder.single_acting else sides))
    return float((inside - outside) * volume / (k * r * temperature * mass_flow))


def rate_for_gas(cylinder: Cylinder, rig: Rig) -> float:
    """Return at how many samples a second its gas is to be recorded; 0 where no valve fills it."""
    seconds = filling_time(cylinder, rig)
    return min(QUICK, _round_up(ENOUGH / seconds)) if np.isfinite(seconds) else 0.0


def slow_for_gas(recording: Recording, rig: Rig) -> list[Finding]:
    """Return a warning for every cylinder whose valve is moved and whose chambers fill within few samples."""
    step, found = float(np.median(np.diff(recording.time))) if len(recording.time) > 1 else 0.0, list[Finding]()
    if step <= 1.01 / QUICK:
        return []
    for name, cylinder in rig.cylinders.items():
        keys = [key for command in cylinder.commands if (key := f"{name}.{command}") in recording]
        seconds = filling_time(cylinder, rig)
        moved = any(np.ptp(recording[key][np.isfinite(recording[key])]) > 0.0 for key in keys if np.isfinite(recording[key]).any())
        if not moved or not any(f"{name}.pressure_{side}" in recording for side in (1, 2)) or seconds >= SLOW * step:
            continue
        rate = rate_for_gas(cylinder, rig)
        within = f"{1e3 * seconds:.{0 if seconds >= 0.01 else 1}f} ms"
        says = (
            f"{1.0 / step:.3g} samples a second are few for the gas of {name}: its valve can fill a chamber in {within}, and "
            f"what a quicker loop told it between samples is not known; record at {rate:g} Hz or more"
        )
        found.append(Finding(keys[0], "slow for gas", says, severity="warning"))
    return found


def _round_up(rate: float) -> float:
    """Return the next rate that begins with 1, 2 or 5."""
    power = 10.0 ** np.floor(np.log10(rate))
    return float(power * next(begins for begins in (1.0, 2.0, 5.0, 10.0) if begins * power >= 0.95 * rate))
