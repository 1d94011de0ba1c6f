"""Running a machine through a program, and what its instruments show of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import TrialError
from exo_sim.trials.whole_machines.draw import Built
from exo_sim.trials.whole_machines.excitation import Program, Range, gains, program
from exo_sim.trials.whole_machines.instruments import Rack, filtered, shown
from exo_sim.trials.whole_machines.loop import FED, GAINS, LOG, MEMO, run
from exo_sim.trials.whole_machines.machine import Machine
from exo_sim.trials.whole_machines.make import Make
from exo_sim.trials.whole_machines.plant import STATES, at_rest

Array = NDArray[np.float64]
Counts = NDArray[np.int64]

#: Rows of the log a second, at least: filters are applied to them before samples are taken.
_FINE = 2000.0


@dataclass(frozen=True)
class Ticks:
    """The clock of a run.

    Attributes:
        steps: Integration steps in each row of the log.
        sub: Rows between two samples.
        dt: Integration step [s].
    """

    steps: Counts
    sub: int
    dt: float


@dataclass(frozen=True)
class Restarts:
    """A run that is started anew at some samples; see `loop.run`.

    Attributes:
        states: To start from, shape (n, STATES + MEMO).
        resets: Where, shape (n,).
    """

    states: Array
    resets: Counts


@dataclass(frozen=True)
class Run:
    """What is true of a machine during a recording.

    Attributes:
        log: Name of `loop.LOG` to values, shape (n * sub,).
        ticks: Its clock.
        states: At each sample, shape (n, STATES + MEMO).
        led: Position, speed and acceleration in each row of a load that is led, shape (n * sub, 3) or (0, 3).
    """

    log: dict[str, Array]
    ticks: Ticks
    states: Array
    led: Array = field(default_factory=lambda: np.zeros((0, 3)))

    @property
    def time(self) -> Array:
        """Times of the samples [s], shape (n,)."""
        return self.log["time"][:: self.ticks.sub]

    def at_samples(self, name: str) -> Array:
        """Return a true signal at the samples, shape (n,)."""
        return self.log[name][:: self.ticks.sub]


def span_of(built: Built) -> Range:
    """Return what an excitation may ask of a machine."""
    m = built.machine
    arm = 0.95 * m["lever_arm"] if m["lever"] else 1.0
    middle = 0.0 if m["lever"] else 0.5 * m["stroke"] - m["zero"]
    share = 0.33 if not (m["cushion_length"] > 0) else 0.5 - 0.4 * m["cushion_length"] / m["stroke"]
    weight = m["gravity"] / arm + m["spring"] * (0.5 * m["stroke"] - m["spring_rest"])
    dead = float(np.mean([m[name] for name in ("lap_s1", "lap_e1", "lap_s2", "lap_e2")]))
    reach = 0.35 * (m["supply"] - m["ambient"]) * m["area_2"]
    return Range(middle, share * m["stroke"] / arm, built.full_speed / arm, weight, reach, built.natural, dead)


def drive(built: Built, names: tuple[str, ...], duration: float, rng: np.random.Generator) -> Run:
    """Run a program.

    Args:
        built: The machine.
        names: Of `excitation.PROGRAMS`.
        duration: Length [s].
        rng: Chance.

    Raises:
        TrialError: the machine left the range of numbers that mean anything, or was not moved.
    """
    m, make = built.machine, built.make
    span = span_of(built)
    dt = m.step()
    steps, sub = ticks(make, dt, duration, rng)
    time = np.concatenate(([0.0], np.cumsum(steps.reshape(-1, sub).sum(axis=1)[:-1]) * dt))
    n = len(time)
    plan = program(names, time, span, rng)
    noise = 1e-5 if not m["lever"] else 1e-5 / m["lever_arm"]
    lag = m["delay"] + (m["lag"] or (2 * m["spool_damping"] / (2 * math.pi * m["spool_frequency"]) if m["spool_frequency"] else 0.0))
    own = gains(span, m.moved_mass, lag + (0.3 / make.rate), noise)
    y = np.zeros(STATES)
    record = m.packed()
    p2 = m["ambient"] + (0.5 * (m["supply"] - m["ambient"]) if m["single_acting"] == 0 else 0.0)
    p1 = (p2 * m["area_2"] + m["ambient"] * (m["area_1"] - m["area_2"]) + span.force) / m["area_1"]
    at_rest(y, span.middle, p1, p2, record[0])
    run_ = advance(m, y, np.zeros(MEMO), Ticks(steps, sub, dt), plan, own, noise * rng.standard_normal(n), keep=True)
    _check(run_, built)
    return run_


def ticks(make: Make, dt: float, duration: float, rng: np.random.Generator) -> tuple[Counts, int]:
    """Return the integration steps of each row of the log, and the rows between two samples: a clock with the make's jitter."""
    sub = max(1, round(_FINE / make.rate))
    n = round(duration * make.rate)
    wish = np.arange(n + 1) / make.rate + np.clip(rng.standard_normal(n + 1), -3, 3) * make.grade.jitter / make.rate
    edges = np.round(np.maximum.accumulate(wish) / dt).astype(np.int64)
    wide = np.maximum(np.diff(edges), sub)
    return (wide[:, None] * (np.arange(sub) + 1) // sub - wide[:, None] * np.arange(sub) // sub).ravel(), sub


def advance(
    m: Machine, y: Array, memo: Array, clock: Ticks, plan: Program, own: Array, noise: Array, keep: bool = False,
    again: Restarts | None = None, led: Array | None = None,
) -> Run:  # fmt: skip
    """Run a machine; see `loop.run`."""
    n = len(plan.mode)
    log = np.zeros((n * clock.sub, len(LOG)))
    anew = again or Restarts(np.zeros((n if keep else 0, STATES + MEMO)), np.zeros(n, np.int64))
    moved = led if led is not None else np.zeros((0, 3))
    driving = (plan.mode, plan.goal, plan.speed, plan.feed, own, noise)
    run(m.packed(), y.copy(), memo.copy(), clock.steps, clock.sub, clock.dt, *driving, log, anew.states, anew.resets, moved)
    return Run({name: log[:, i] for i, name in enumerate(LOG)}, clock, anew.states, moved)


def replayed(m: Machine, truth: Run, starts: Array, resets: Counts) -> Run:
    """Run a machine on the commands of another run, started anew where `resets` says so; see `loop.run`."""
    n = len(truth.time)
    nothing = np.zeros(n)
    plan = Program(np.full(n, FED, np.int64), nothing, nothing, truth.at_samples("command"))
    again = Restarts(starts.copy(), resets)
    return advance(m, starts[0, :STATES], starts[0, STATES:], truth.ticks, plan, np.zeros(GAINS), nothing, again=again, led=truth.led)


def _check(one: Run, built: Built) -> None:
    m = built.machine
    x, p1 = one.log["piston"], one.log["pressure_1"]
    if not (np.isfinite(p1).all() and np.isfinite(x).all()) or x.min() < -0.01 or x.max() > m["stroke"] + 0.01:
        raise TrialError("a drawn machine diverged; draw it again with another --seed")
    at_end = np.mean((x < 1e-4) | (x > m["stroke"] - 1e-4))
    if np.ptp(x) < 0.25 * m["stroke"] or at_end > 0.35:
        raise TrialError("a drawn machine hardly moved or lay at its end; draw it again with another --seed")


def recorded(one: Run, rack: Rack, built: Built, columns: tuple[str, ...], rng: np.random.Generator) -> dict[str, Array]:
    """Return the table of a recording: column of the contract to values, `time [s]` first."""
    make = built.make
    rate = make.rate * one.ticks.sub
    joint_unit = "rad" if make.build == "lever" else "m"
    where = {
        f"{make.cylinder}.valve_command [1]": ("command", None),
        f"{make.cylinder}.pressure_1 [Pa]": ("pressure_1", rack.pressure_1),
        f"{make.cylinder}.pressure_2 [Pa]": ("pressure_2", rack.pressure_2),
        f"{make.joint}.position [{joint_unit}]": ("position", rack.position),
        f"{make.cylinder}.force [N]": ("force", rack.force),
        "supply.pressure [Pa]": ("supply", rack.supply),
    }
    table = {"time [s]": one.time}
    for column, (name, channel) in where.items():
        if name not in columns:
            continue
        if channel is None:
            table[column] = one.at_samples(name)
        else:
            table[column] = shown(filtered(one.log[name], channel, rate)[:: one.ticks.sub], channel, rng)
    if make.grade.lost > 0.0:
        there = rng.random(len(one.time)) >= make.grade.lost
        there[[0, -1]] = True
        table = {column: values[there] for column, values in table.items()}
    return table
