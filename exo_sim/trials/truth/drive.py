"""Running a bench through a program: machine and excitation to a log of what is true."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import TrialError
from exo_sim.trials.truth.bench import Bench
from exo_sim.trials.truth.excitation import Program, program
from exo_sim.trials.truth.loop import run
from exo_sim.trials.truth.machine import Machine
from exo_sim.trials.truth.state import LOG, STATES, at_rest

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Truth:
    """What is true at each tick.

    Attributes:
        log: Name of `plant.LOG` to values, shape (n,).
        ticks: Steps of `dt` between ticks, shape (n,).
        dt: Integration step [s].
        states: Full state at each tick, shape (n, STATES + 5).
    """

    log: dict[str, Array]
    ticks: NDArray[np.int64]
    dt: float
    states: Array


def drive(
    bench: Bench,
    machine: Machine,
    kind: str,
    duration: float,
    rate: float,
    jitter: float,
    reach: float,
    rng: np.random.Generator,
    keep: bool = False,
) -> Truth:
    """Run one program.

    Args:
        bench: The bench as built: sets gains, travel and openings.
        machine: The true machine, hidden things included.
        kind: One of `excitation.PROGRAMS`.
        duration: Length [s].
        rate: Ticks a second [Hz].
        jitter: Standard deviation of the tick period [s].
        reach: Largest excursion from mid-stroke, as a share of half the stroke.
        rng: Chance.
        keep: Keep the full state at every tick.

    Raises:
        TrialError: the machine left the range of numbers that mean anything.
    """
    dt = machine.step()
    n = round(duration * rate)
    period = 1.0 / rate
    wish = np.arange(n + 1) * period + np.clip(rng.standard_normal(n + 1), -3, 3) * jitter
    ticks = np.maximum(np.diff(np.round(wish / dt)), 1).astype(np.int64)
    time = np.concatenate(([0.0], np.cumsum(ticks[:-1]) * dt))
    travel = reach * 0.5 * bench.stroke
    opening = min(4 * travel / bench.full_speed, 0.6)
    plan = program(kind, time, 0.5 * bench.stroke, travel, opening, rng)
    gains = controller(bench, opening, travel)
    noise = 2e-5 * rng.standard_normal(n)
    record = machine.packed()
    p2 = 0.55 * bench.supply
    weight = bench.mass * machine["gravity"] + machine["spring_stiffness"] * (
        0.5 * bench.stroke - machine["spring_rest"]
    )
    p1 = (p2 * bench.area_2 + bench.ambient * (bench.area_1 - bench.area_2) + weight) / bench.area_1
    y = at_rest(0.5 * bench.stroke, p1, p2, record[0])
    truth = advance(machine, y, np.zeros(4), 0.0, ticks, dt, plan, gains, noise, keep)
    if not np.isfinite(truth.log["pressure_1"]).all() or abs(truth.log["position"]).max() > 10 * bench.stroke:
        raise TrialError("a drawn machine diverged; draw it again with another --seed")
    return truth


def advance(
    machine: Machine,
    y: Array,
    bristle: Array,
    start: float,
    ticks: NDArray[np.int64],
    dt: float,
    plan: Program,
    gains: Array,
    noise: Array,
    keep: bool = False,
) -> Truth:
    """Run a machine from a given state; see `plant.run`."""
    log = np.empty((len(ticks), len(LOG)))
    states = np.empty((len(ticks) if keep else 0, STATES + 5))
    run(
        machine.packed(),
        y.copy(),
        bristle.copy(),
        start,
        ticks,
        dt,
        plan.mode,
        plan.goal,
        plan.speed,
        plan.feed,
        gains,
        noise,
        log,
        states,
    )
    return Truth({name: log[:, i] for i, name in enumerate(LOG)}, ticks, dt, states)


def controller(bench: Bench, opening: float, travel: float) -> Array:
    """Return the gains of the bench's own crude controller: position, velocity, force, and pull to the middle."""
    natural = math.sqrt(bench.gas_stiffness / bench.mass)
    position = min(0.3 * natural, 14.0) / bench.full_speed
    force = 2 * 0.4 / (bench.full_speed * natural * bench.mass)
    return np.array([position, 0.4 / bench.full_speed, force, 0.6 * opening / travel])
