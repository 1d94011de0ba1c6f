"""The gas cut: command, supply and piston motion go in as recorded, both chamber pressures come out, window by window."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.filters import start_filter
from exo_sim.diagnosis.observed import CylinderRun
from exo_sim.diagnosis.window_starts import cuts, unrest
from exo_sim.physics import chamber, plant, state
from exo_sim.physics.compiled import kernel
from exo_sim.physics.pneumatics import Pneumatics
from exo_sim.physics.transmission import gives

Array = NDArray[np.float64]

#: Steps as long as a sample, and few: a fit asks for thousands of runs, some of them with absurd machines.
LONGEST_STEP, MOST_STEPS = 1e-3, 8.0

#: ... and where the sensor sits behind a hose, of which it shows every error, no longer than this [s].
HOSE_STEP = 5e-4

#: Samples of delayed commands that are kept for the next time.
MOST_KEPT = 2_000_000

#: Samples that estimate the pressure at the start of a window, and the longest time that they may span [s].
START_SAMPLES, START_SECONDS = 15, 0.03


@kernel
def predict(
    world, cylinders, vector, time, command, length, supply, exhaust, supply_temperature, starts, start_pressure,
    work, scratch, out, inside, drawn, warmth,
):  # fmt: skip
    """Run one cylinder through a recording with its pressures set right at the start of every window.

    A chamber's temperature is carried from window to window: no recording holds it, and the gas remembers.

    Args:
        world, cylinders: Records, shape (1,) each; the world's supply and exhaust are overwritten sample by sample.
        vector: State of one cylinder, filled.
        time, command, length, supply, exhaust, supply_temperature: Inputs, shape (n,).
        starts: Index of each window's first sample, rising, shape (w,).
        start_pressure: Measured pressures there, shape (w, 2); NaN keeps the prediction.
        out: Predicted pressures as the sensors would have them, shape (n, 2).
        inside: Predicted pressures in the chambers themselves, shape (n, 2); these three may be empty, then they are not asked for.
        drawn: Mass flow from the supply over the step that follows each sample [kg/s], shape (n,).
        warmth: Predicted gas temperatures, shape (n, 2).
    """
    whole = drawn.size > 0
    n = time.size
    c = cylinders[0]
    k = world[0].k
    memory = state.INTEGRATED + state.SHARED
    window = 0
    x0, x1, u = np.empty(1), np.empty(1), np.empty(1)
    hose = c.line_restriction.area > 0.0
    at_valve = hose and c.line_restriction.sensor > 0.5
    for i in range(n):
        world[0].supply_pressure = supply[i]
        world[0].exhaust_pressure = exhaust[i]
        world[0].supply_temperature = supply_temperature[i]
        here = vector[memory + state.PISTON] if gives(c) else length[i]
        if window < starts.size and starts[window] == i:
            v_1, v_2 = plant.volumes(c, here)
            for side in range(2):
                target = start_pressure[window, side]
                if math.isnan(target) or (side == 1 and c.single_acting > 0.0):
                    continue
                mass, energy = 2 * side, 2 * side + 1
                hose_mass, hose_energy = state.HOSE_MASS_1 + 2 * side, state.HOSE_MASS_1 + 2 * side + 1
                volume = v_1 if side == 0 else v_2
                p = chamber.pressure(vector[energy], volume, k)
                seen = p
                if at_valve:
                    seen = chamber.pressure(vector[hose_energy], c.line_restriction.volume, k)
                factor = max(p + target - seen, 1000.0) / p
                vector[mass] *= factor
                vector[energy] *= factor
                if hose:
                    q = chamber.pressure(vector[hose_energy], c.line_restriction.volume, k)
                    factor = max(q + target - seen, 1000.0) / q
                    vector[hose_mass] *= factor
                    vector[hose_energy] *= factor
            window += 1
        p_1, p_2 = plant.pressures(world[0], c, vector, 0, here)
        if whole:
            t_1, t_2 = plant.temperatures(world[0], vector, 0)
            warmth[i, 0], warmth[i, 1] = t_1, t_2
            inside[i, 0], inside[i, 1] = p_1, p_2
        if at_valve:
            out[i, 0] = chamber.pressure(vector[state.HOSE_ENERGY_1], c.line_restriction.volume, k)
            out[i, 1] = chamber.pressure(vector[state.HOSE_ENERGY_2], c.line_restriction.volume, k)
        else:
            out[i, 0], out[i, 1] = p_1, p_2
        if i + 1 < n:
            dt = time[i + 1] - time[i]
            before = vector[state.DRAWN]
            if dt < 0.5:
                x0[0], x1[0], u[0] = length[i], length[i + 1], command[i]
                plant.advance(world[0], cylinders, vector, x0, x1, u, dt, work, scratch)
            if whole:
                drawn[i] = (vector[state.DRAWN] - before) / dt


def late_command(time: Array, command: Array, delay: float) -> Array:
    """Return the mean over each step of a held command that arrives `delay` seconds late, shape (n,)."""
    if delay == 0.0:
        return command
    total = np.concatenate([[0.0], np.cumsum(command[:-1] * np.diff(time))])
    edges = np.append(time, 2 * time[-1] - time[-2]) - delay
    passed = np.interp(edges, time, total)
    passed += np.minimum(edges - time[0], 0.0) * command[0] + np.maximum(edges - time[-1], 0.0) * command[-1]
    return np.diff(passed) / np.diff(edges)


@dataclass
class Windows:
    """Where predictions start and what is compared: `starts` (w,), `stops` (w,), and start pressures (w, 2): measured; at the very
    first of a chamber that was not measured, as the forces have it; else NaN.
    """

    starts: NDArray[np.int64]
    stops: NDArray[np.int64]
    pressure: Array


def windows(run: CylinderRun, seconds: float) -> Windows:
    """Cut a run into windows of about `seconds` that no break of the clock lies in, each begun where the gas is quiet nearby."""
    starts: list[int] = []
    stops: list[int] = []
    time = run.time
    restless = unrest(run.pressure, len(time))
    edges = [*run.breaks, len(time)]
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        found = cuts(time, begin, end, seconds, restless)
        starts += found
        stops += [*found[1:], end]
    pressure = np.full((len(starts), 2), np.nan)
    points = min(START_SAMPLES, int(START_SECONDS / max(float(np.median(np.diff(time))), 1e-9)) + 1) if len(time) > 1 else 1
    for side, values in enumerate(run.pressure):
        if values is None:
            pressure[0, side] = run.begun[side]
            continue
        for w, (begin, end) in enumerate(zip(starts, stops, strict=True)):
            pressure[w, side] = _start(values[begin:end], points)
    return Windows(np.array(starts), np.array(stops), pressure)


def _start(values: Array, points: int) -> float:
    good = np.isfinite(values)
    if not good.any():
        return math.nan
    points = min(points, len(values))
    if points < 5 or not good[:points].all():
        return float(values[int(np.argmax(good))])
    return float(start_filter(points) @ values[:points])


@dataclass
class GasInputs:
    """What `predict` is fed with, from one run; supply and exhaust filled with the rig's constants where not recorded."""

    run: CylinderRun
    time: Array
    command: Array
    length: Array
    supply: Array
    exhaust: Array
    supply_temperature: Array
    windows: Windows
    _delayed: dict[float, Array] = field(default_factory=dict)

    def command_after(self, delay: float) -> Array:
        """Return the command as it reaches the valve `delay` seconds late."""
        found = self._delayed.get(delay)
        if found is None:
            if len(self._delayed) > max(2, MOST_KEPT // len(self.time)):
                self._delayed.clear()
            found = self._delayed[delay] = late_command(self.time, self.command, delay)
        return found


def inputs(run: CylinderRun, world: NDArray[np.void], seconds: float) -> GasInputs:
    """Return the inputs of the gas cut for windows of about `seconds`."""
    n = len(run.time)
    assert run.length is not None
    record = world[0]

    def constant(values: Array | None, name: str) -> Array:
        return np.full(n, float(record[name])) if values is None else values

    return GasInputs(
        run, run.time, run.command, run.length, constant(run.supply, "supply_pressure"),
        constant(run.exhaust, "exhaust_pressure"), constant(run.supply_temperature, "supply_temperature"), windows(run, seconds),
    )  # fmt: skip


@dataclass
class GasPrediction:
    """What one run would show.

    Attributes:
        pressure: As the sensors have it, shape (n, 2) [Pa].
        inside: In the chambers themselves, shape (n, 2) [Pa].
        drawn: Flow from the supply, shape (n,) [kg/s].
        temperature: Of the gas, shape (n, 2) [K].
    """

    pressure: Array
    inside: Array
    drawn: Array
    temperature: Array


def behind_hose(cylinder: NDArray[np.void]) -> bool:
    """Say whether a hose lies between a cylinder, record of shape (1,), and its pressure sensors."""
    hose = cylinder["line_restriction"][0]
    return bool(hose["area"] > 0.0 and hose["sensor"] > 0.5)


def run_gas(
    feed: GasInputs, world: NDArray[np.void], cylinder: NDArray[np.void], shift: float = 0.0, length_delay: float = 0.0,
    offset: tuple[float, float] = (0.0, 0.0), whole: bool = True,
) -> GasPrediction:  # fmt: skip
    """Predict the pressures of one run.

    Args:
        feed: Inputs.
        world, cylinder: Records, shape (1,) each; not changed.
        shift: Added to the pressures at the start of every window [Pa], to see what an error there does.
        length_delay: Seconds by which the position sensor is late.
        offset: Taken off the measured start pressures [Pa]: what the sensors read too much.
        whole: Whether more than the pressures at the sensors is wanted; else the rest of the prediction is empty.
    """
    world, cylinder = world.copy(), cylinder.copy()
    usual = float(np.median(np.diff(feed.time)))
    world["longest_step"], world["most_steps"] = max(LONGEST_STEP, 0.5 * usual), MOST_STEPS
    if behind_hose(cylinder):
        world["longest_step"] = min(world["longest_step"][0], max(HOSE_STEP, usual / MOST_STEPS))
    n = len(feed.time)
    length = feed.length
    if length_delay != 0.0:
        length = np.interp(feed.time + length_delay, feed.time, length)
    gas = Pneumatics(world, cylinder, dt=1.0)
    start = feed.windows.pressure + shift - np.array(offset)
    first = np.where(np.isfinite(start[0]), start[0], world["atmosphere"][0])
    world["supply_pressure"], world["exhaust_pressure"] = feed.supply[0], feed.exhaust[0]
    gas.fill(length[:1], first[:1], first[1:])
    if bool(gives(cylinder[0])):
        gas.settle_transmission(length[:1])
    rest = n if whole else 0
    out, inside, drawn, warmth = np.empty((n, 2)), np.empty((rest, 2)), np.zeros(rest), np.empty((rest, 2))
    gas.memory[0, state.SPOOL] = gas.memory[0, state.PLAY] = feed.command[0]
    predict(
        world, cylinder, gas.vector, feed.time, feed.command_after(float(cylinder["valve_lag"]["delay"][0])), length, feed.supply,
        feed.exhaust, feed.supply_temperature, feed.windows.starts, start, gas._work, gas._scratch, out, inside, drawn, warmth,
    )  # fmt: skip
    return GasPrediction(out, inside, drawn, warmth)
