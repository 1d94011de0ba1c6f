"""Predicted chamber pressures of one cylinder under measured command, supply and piston motion, window by window."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.subsystems.gas.initial_play import begun_plays
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs
from exo_sim.physics import chamber, plant, state
from exo_sim.physics.compiled import borrow, kernel, own_array, own_copy
from exo_sim.physics.effects import exhaust_back_pressure, line_restriction, valve_hysteresis, valve_lag
from exo_sim.physics.nodes import change_hose_pressure, change_pressure
from exo_sim.physics.pneumatics import Pneumatics
from exo_sim.physics.settling import hot_gas, settling_rate
from exo_sim.physics.step_length import CLASSIC_TURN
from exo_sim.physics.transmission import gives
from exo_sim.recording import windows

Array = NDArray[np.float64]

#: A fit may try a bias larger than a reading, but no window starts with less gas than this [Pa].
LEAST_START = 100.0
#: Longest step [s] and most steps a sample: a fit asks for thousands of predictions, some of them of absurd machines. Steps of 1.24 ms, a
#: sample of learn machine X3, are off by 8 to 27 Pa and twice by 59 and 109; halves by 2 to 9, and 17 and 93; no other was asked.
LONGEST_STEP, MOST_STEPS = 1.5e-3, 8.0
#: The shortest step where waves pass in a hose [s], and the speed of sound in a room [m/s].
WAVE_STEP, SOUND = 1e-4, 343.0
#: A wave is followed that takes longer than so many of the times of which a fit shows anything: of 1 ms, 0.51 m are passed.
FOLLOWED = 1.5
#: Flow of choked air, over its density, the area and the speed of sound: (2/(k + 1))^((k + 1)/(2 (k - 1))) is 0.58 for k = 1.4.
CHOKED = 0.6
#: A throttle that stops the flow of choked gas so many times over in the time of which a fit shows anything leaves it no inertia; asserted.
#: The lumped hose that is predicted then has its middle on the valve's side: of 1 m, stopped 8 times over, that is 5 kPa rms of 212.
STOPPED = 20.0
#: The usual longest step where the sensor sits behind a hose, whose small volume shows every error of integration [s].
HOSE_STEP = 5e-4
#: A sample with a hose takes about so many times as long, and behind one; of a slow logger as many as it has steps. Learn makes A, B and C,
#: 1 to 5 ms: 1.6, 2.3 and 6.5 times, behind it 2.5, 3.6 and 7.3.
HOSE_EFFORT, SENSED_EFFORT = 2, 3
#: The usual step where a wave passes (`wave_rate`), of the time that it takes through the hose, and for how many plain samples such a step
#: counts: at 1 kHz 1.2 to 5 m of hose take 2.4 to 2.9 times as long as none, 0.55 to 0.8 m 4.7 to 5.4 times (learn make X1, 14 s).
WAVE_SHARE, WAVE_EFFORT = CLASSIC_TURN / 4.0, 3
#: What a prediction costs whatever its length, in plain samples: 400 take 1.3 ms, 20,000 take 11 ms.
EACH_EFFORT = 1500
#: Of a slow logger's sample neither a shorter part is resolved, nor do steps behind a hose get shorter.
RESOLVED = 0.2
#: Over a gap in the clock that is longer than this, and a jump of it, nothing is predicted [s].
GAP = 0.5
#: What settles faster than this, behind a choked path, is not resolved [s]: a fifth of the shortest row of a fit.
SETTLED = 1e-3

#: The state of one cylinder, and what a step of it writes to.
_vector, _work, _scratch = own_array(state.size(1, 0)), own_array(5, state.integrated_size(1)), own_array(8, 2)


@kernel
def predict(
    world, cylinders, vector, time, gap, command, first, length, supply, exhaust, supply_temperature, starts, start_pressure,
    out, inside, drawn, warmth,
):  # fmt: skip
    """Run one cylinder through a recording, its pressures set to the measured ones at the start of every window.

    A chamber's temperature is carried from window to window, for no sensor measures it.

    Args:
        world, cylinders: Records, shape (1,) each.
        vector: State of one cylinder, filled.
        time, length, supply, exhaust, supply_temperature: Inputs, shape (n,).
        gap: Nothing is predicted over a step of the clock that is no shorter [s].
        command: Towards both chambers over the first part of each step and over the rest, shape (n, 4); the second and fourth count
            where the valve has independent edges.
        first: Length of the first part [s], shape (n,); 0 where a step is one part.
        starts: Index of each window's first sample, increasing, shape (w,).
        start_pressure: Measured pressures there, shape (w, 2); NaN keeps the prediction.
        out: Predicted pressures where the sensors sit, shape (n, 2).
        inside: Predicted pressures in the chambers, shape (n, 2); this and the next two may be empty, then they are left out.
        drawn: Mass flow from the supply over the step that follows each sample [kg/s], shape (n,).
        warmth: Predicted gas temperatures, shape (n, 2).
    """
    world, cylinders, vector, start_pressure = borrow((world, cylinders, vector, start_pressure))
    time, command, first, length, supply, exhaust = borrow((time, command, first, length, supply, exhaust))
    supply_temperature, starts, out, inside, drawn, warmth = borrow((supply_temperature, starts, out, inside, drawn, warmth))
    whole = drawn.size > 0
    n = time.size
    c, w = own_copy(cylinders[0]), own_copy(world[0])
    alone = (c,)
    k = w.k
    memory = state.INTEGRATED + state.SHARED
    window = 0
    own, work, scratch = _vector(), _work(), _scratch()
    for j in range(own.size):
        own[j] = vector[j]
    work[:] = 0.0
    u, x0, x1 = scratch[5], scratch[6, :1], scratch[7, :1]
    at_valve = line_restriction.present(c.line_restriction) and c.line_restriction.sensor > 0.5
    node = line_restriction.node_volume(c.line_restriction)
    for i in range(n):
        w.supply_pressure = supply[i]
        w.exhaust_pressure = exhaust[i]
        w.supply_temperature = supply_temperature[i]
        here = own[memory + state.PISTON] if gives(c) else length[i]
        if window < starts.size and starts[window] == i:
            v_1, v_2 = plant.volumes(c, here)
            for side in range(2):
                target = start_pressure[window, side]
                if math.isnan(target) or (side == 1 and c.single_acting > 0.0):
                    continue
                volume = v_1 if side == 0 else v_2
                seen = chamber.pressure(own[state.ENERGY_1 + 2 * side], volume, k)
                if at_valve:
                    seen = chamber.pressure(own[state.HOSE_ENERGY_1 + 2 * side], node, k)
                change_pressure(own, state.MASS_1 + 2 * side, volume, target - seen, k)
                change_hose_pressure(c, own, 0, side, target - seen, k)
            window += 1
        p_1, p_2 = plant.pressures(w, c, own, 0, here)
        if whole:
            t_1, t_2 = plant.temperatures(w, own, 0)
            warmth[i, 0], warmth[i, 1] = t_1, t_2
            inside[i, 0], inside[i, 1] = p_1, p_2
        if at_valve:
            out[i, 0] = chamber.pressure(own[state.HOSE_ENERGY_1], node, k)
            out[i, 1] = chamber.pressure(own[state.HOSE_ENERGY_2], node, k)
        else:
            out[i, 0], out[i, 1] = p_1, p_2
        if i + 1 < n:
            dt = time[i + 1] - time[i]
            before = own[state.DRAWN]
            if dt < gap:
                part, to = first[i], length[i + 1]
                x1[0] = length[i]
                for rest in range(0 if part > 0.0 else 1, 2):
                    x0[0] = x1[0]
                    span = dt if part == 0.0 else (part if rest == 0 else dt - part)
                    x1[0] = to if rest == 1 else length[i] + (to - length[i]) * part / dt
                    column = 2 if rest == 1 and part > 0.0 else 0
                    u[0], u[1] = command[i, column], command[i, column + 1]
                    plant.advance(w, alone, own, x0, x1, u, span, work, scratch, whole)
            if whole:
                drawn[i] = (own[state.DRAWN] - before) / dt


def _widen_hose(world: NDArray[np.void], cylinder: NDArray[np.void], seconds: float) -> None:
    """Enlarge a hose that settles faster than in some seconds until it settles in these, at the expense of the dead volumes.

    What is faster no row of a fit shows, and an explicit step pays for it many times over; gas that is stored stays the same. So it is
    with a wave: a hose through which sound passes in that time and a half, or whose throttle stops the flow at once, has no inertia.
    """
    hose = cylinder[line_restriction.EFFECT.name]
    if shows_waves(cylinder, seconds):
        return
    if line_restriction.has_inertia(hose[0]):
        for side in ("dead_volume_1", "dead_volume_2"):
            cylinder[side] += line_restriction.volume_at_chamber(hose[0])
        hose["volume"] = line_restriction.node_volume(hose[0]) + line_restriction.middle_volume(hose[0])
        hose["length"] = 0.0
    area, volume = float(hose["area"][0]), float(hose["volume"][0])
    more = _volume_that_settles(world, area, seconds) - volume
    if area > 0.0 and more > 0.0:
        hose["volume"] = volume + more
        for side in ("dead_volume_1", "dead_volume_2"):
            cylinder[side] = np.maximum(cylinder[side] - more, 0.5 * cylinder[side])


def _widen_silencer(world: NDArray[np.void], seconds: float) -> None:
    """Enlarge a silencer that settles faster than in some seconds until it settles in these: towards equal pressures 50 times faster.

    How much gas it holds is hardly seen then, but for what is drawn back from it, which comes as cold as it left. Machine m10 of the
    twelfth stranger, 200 samples a second, a silencer of 20 cm^3: as wide as ten valves a prediction took 64 ms, so widened 12 ms (2.8 ms
    without one), and as wide as three it differs by 1.3 Pa.
    """
    silencer = world[exhaust_back_pressure.EFFECT.name]
    silencer["volume"] = np.maximum(silencer["volume"], _volume_that_settles(world, float(silencer["area"][0]), seconds))


def _volume_that_settles(world: NDArray[np.void], area: float, seconds: float) -> float:
    """Return which volume settles in some seconds behind a choked path [m^3]."""
    return settling_rate(area, 1.0, hot_gas(float(world["k"][0]), float(world["r"][0]))) * seconds


@dataclass(frozen=True)
class GasPrediction:
    """What is predicted of one run.

    Attributes:
        pressure: Where the sensors sit, shape (n, 2) [Pa].
        inside: In the chambers, shape (n, 2) [Pa].
        drawn: Flow from the supply, shape (n,) [kg/s].
        temperature: Of the gas, shape (n, 2) [K].
        before_sensors: Where the sensors sit, before their gains, zeros and delays, shape (n, 2) [Pa]; None where `pressure` is
            that, or nothing else was asked for.
        samples: How many were predicted for it: with those that say where a play begins more than it has.
    """

    pressure: Array
    inside: Array
    drawn: Array
    temperature: Array
    before_sensors: Array | None = None
    samples: int = 0


def effort_of(samples: int, period: float, cylinder: NDArray[np.void]) -> int:
    """Return how many plain samples a prediction of so many, one every `period` [s], costs; for a cylinder, record of shape (1,)."""
    if not cylinder[line_restriction.EFFECT.name]["area"][0] > 0.0:
        return EACH_EFFORT + samples
    least, step = (SENSED_EFFORT, HOSE_STEP) if behind_hose(cylinder) else (HOSE_EFFORT, LONGEST_STEP)
    hose = cylinder[line_restriction.EFFECT.name][0]
    if shows_waves(cylinder, resolved(period)):
        return EACH_EFFORT + samples * max(WAVE_EFFORT * math.ceil(period * SOUND / (WAVE_SHARE * float(hose["length"]))), least)
    return EACH_EFFORT + samples * round(min(max(period / step, least), MOST_STEPS))


def resolved(period: float) -> float:
    """Return the time of which a fit shows anything, of samples one every `period` [s]."""
    return max(min(period, SETTLED), RESOLVED * period)


def shows_waves(cylinder: NDArray[np.void], seconds: float) -> bool:
    """Return whether a fit shows waves in a hose of which it resolves so many seconds: sound takes longer than that and a half through
    it, and its throttle does not stop the flow at once; of a cylinder, record of shape (1,).
    """
    hose = cylinder[line_restriction.EFFECT.name][0]
    if not line_restriction.has_inertia(hose):
        return False
    area = float(hose["area"])
    stopped = line_restriction.friction_rate(hose, 0.5 / area**2, CHOKED * SOUND * area)  # of any density
    return bool(float(hose["length"]) > FOLLOWED * SOUND * seconds and stopped * seconds < STOPPED)


def behind_hose(cylinder: NDArray[np.void]) -> bool:
    """Return whether a hose lies between a cylinder, record of shape (1,), and its pressure sensors."""
    hose = cylinder[line_restriction.EFFECT.name][0]
    return bool(hose["area"] > 0.0 and hose["sensor"] > 0.5)


def run_gas(
    feed: GasInputs, world: NDArray[np.void], cylinder: NDArray[np.void], shift: float = 0.0, length_delay: float = 0.0,
    offset: tuple[float, float] = (0.0, 0.0), whole: bool = True, card_delay: float = 0.0, warmth: tuple[float, float] = (0.0, 0.0),
) -> GasPrediction:  # fmt: skip
    """Predict the pressures of one run.

    Args:
        feed: Inputs.
        world, cylinder: Records, shape (1,) each; not changed.
        shift: Added to the pressures at the start of every window [Pa], for their sensitivity.
        length_delay: Delay of the position sensor [s].
        offset: Subtracted from the measured start pressures [Pa]: bias of the sensors.
        card_delay: Delay of the card of the pressures, on whose clock the prediction runs: motion and command come later by it [s].
        whole: Whether more than the pressures at the sensors is wanted; else the rest of the prediction is empty.
        warmth: By how much the gas of each chamber is warmer than the surroundings when the run begins [K].
    """
    world, cylinder = world.copy(), cylinder.copy()
    usual = feed.period
    most = max(MOST_STEPS, usual / WAVE_STEP) if shows_waves(cylinder, resolved(usual)) else MOST_STEPS
    world["longest_step"], world["most_steps"] = max(LONGEST_STEP, 0.5 * usual), most
    if behind_hose(cylinder):
        world["longest_step"] = min(world["longest_step"][0], max(feed.hose_step or HOSE_STEP, RESOLVED * usual))
    _widen_hose(world, cylinder, resolved(usual))
    _widen_silencer(world, resolved(usual))
    n = len(feed.time)
    length = feed.length
    if length_delay != card_delay:
        length = np.interp(feed.time + length_delay - card_delay, feed.time, length)
    gas = Pneumatics(world, cylinder, dt=1.0)
    start = np.maximum(feed.windows.pressure + shift - np.array(offset), LEAST_START)
    first = np.where(np.isfinite(start[0]), start[0], world["atmosphere"][0])
    world["supply_pressure"], world["exhaust_pressure"] = feed.supply[0], feed.exhaust[0]
    gas.fill(length[:1], first[:1], first[1:])
    for mass, kelvin in zip((state.MASS_1, state.MASS_2), warmth, strict=True):
        gas.integrated[:, mass] /= 1.0 + kelvin / world["ambient"][0]
    if bool(gives(cylinder[0])):
        gas.settle_transmission(length[:1])
    rest = n if whole else 0
    out, inside, drawn, temperature = np.empty((n, 2)), np.empty((rest, 2)), np.zeros(rest), np.empty((rest, 2))
    lag = cylinder[valve_lag.EFFECT.name][0]
    delay = float(lag["delay"])
    arrived = feed.command_after(delay + card_delay, valve_lag.let_go_after(lag) - delay, float(lag["reversal"]))
    gap = max(GAP, windows.JUMP * usual)
    width = float(cylinder[valve_hysteresis.EFFECT.name]["width"][0])

    samples = 0

    def predicted(m: int, plays: Sequence[float], others: tuple[Array, Array, Array]) -> Array:
        nonlocal samples
        samples += m
        for place, spool, command in ((plays[0], state.SPOOL, feed.command), (plays[1], state.SPOOL_2, feed.command_2)):
            gas.memory[0, spool] = command[0] + 0.5 * width * place
        predict(
            world, cylinder, gas.vector, feed.time[:m], gap, arrived.command[:m], arrived.first[:m], length[:m], feed.supply[:m],
            feed.exhaust[:m], feed.supply_temperature[:m], feed.windows.starts, start, out[:m], *others,
        )  # fmt: skip
        return out[:m]

    nothing = (np.empty((0, 2)), np.zeros(0), np.empty((0, 2)))
    together = not bool(cylinder["independent"][0] > 0.0)
    plays = begun_plays(feed, width, together, lambda m, places: predicted(m, places, nothing)) if feed.run.commanded else (0.0, 0.0)
    predicted(n, plays, (inside, drawn, temperature))
    return GasPrediction(out, inside, drawn, temperature, samples=samples)
