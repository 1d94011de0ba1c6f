"""What people do with a rig while it is recorded: pieces of a few seconds, open and closed loop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.trials.whole_machines.loop import FED, FORCES, GAINS, POSITION, PULLED, SWITCHED, TURNED

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Range:
    """What the excitation may ask of a machine.

    Attributes:
        middle, travel: Joint position and excursion from it [m or rad].
        fastest: About how fast the joint moves at full command [m/s or rad/s].
        force, reach: Gas force that carries the load, and how far from it forces may be asked [N].
        natural: Natural frequency on the gas [rad/s].
        dead: Command at which the valve begins to open.
    """

    middle: float
    travel: float
    fastest: float
    force: float
    reach: float
    natural: float
    dead: float


@dataclass
class Program:
    """Inputs of `loop.run`, each of shape (n,)."""

    mode: NDArray[np.int64]
    goal: Array
    speed: Array
    feed: Array


def program(names: tuple[str, ...], time: Array, span: Range, rng: np.random.Generator) -> Program:
    """Return the pieces named one after another; each starts where the middle is.

    Args:
        names: Of `PROGRAMS`.
        time: Ticks [s], shape (n,).
        span: What may be asked.
        rng: Chance.
    """
    n = len(time)
    out = Program(np.full(n, POSITION, np.int64), np.full(n, span.middle), np.zeros(n), np.zeros(n))
    shares = rng.uniform(0.8, 1.2, len(names))
    edges = np.concatenate([[0.0], np.cumsum(shares / shares.sum())]) * n
    for name, left, right in zip(names, edges[:-1].astype(int), edges[1:].astype(int)):
        rows = slice(left, right)
        PROGRAMS[name](out, rows, time[rows] - time[left], span, rng)
    return out


def _sines(t: Array, low: float, high: float, rng: np.random.Generator, count: int = 5) -> tuple[Array, Array]:
    """Return a sum of sines within -1..1 and its rate of change."""
    f = np.exp(np.linspace(np.log(low), np.log(high), count)) * rng.uniform(0.85, 1.15, count)
    phase = rng.uniform(0, 2 * np.pi, count)
    weight = 1 / np.sqrt(f / low)
    angle = 2 * np.pi * np.outer(t, f) + phase
    wave, rate = np.sin(angle) @ weight, (2 * np.pi * f * np.cos(angle)) @ weight
    peak = max(abs(wave).max(), 1e-9)
    return wave / peak, rate / peak


def _soft(t: Array, goal: Array, span: Range) -> tuple[Array, Array]:
    """Return a goal that never asks for more than two thirds of the fastest motion, and its speed."""
    h = np.diff(t, append=2 * t[-1] - t[-2])
    out, most = np.empty_like(goal), 0.65 * span.fastest
    place = span.middle
    for i, wanted in enumerate(goal):
        place += min(max(wanted - place, -most * h[i]), most * h[i])
        out[i] = place
    return out, np.gradient(out, t)


def _tracking(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    top = min(2.5, 0.12 * span.natural)
    wave, rate = _sines(t, 0.15, top, rng)
    size = min(span.travel, 0.6 * span.fastest / max(abs(rate).max(), 1e-9))
    goal, speed = _soft(t, span.middle + size * wave, span)
    out.goal[rows], out.speed[rows], out.feed[rows] = goal, speed, _forward(speed, span)


def _triangles(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    times, goals = [0.0], [span.middle]
    while times[-1] < t[-1]:
        there = span.middle + span.travel * rng.uniform(0.4, 1.0) * (-1 if goals[-1] > span.middle else 1)
        speed = span.fastest * np.exp(rng.uniform(np.log(0.015), np.log(0.25)))
        times.append(times[-1] + abs(there - goals[-1]) / speed)
        goals.append(there)
    goal = np.interp(t, times, goals)
    speed = np.gradient(goal, t)
    out.goal[rows], out.speed[rows], out.feed[rows] = goal, speed, _forward(speed, span)


def _places(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    goal = _held(t, rng, 0.5, 1.6) * span.travel + span.middle
    out.goal[rows], out.speed[rows] = goal, 0.0


def _steps(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    out.mode[rows] = PULLED
    levels = _held(t, rng, 0.25, 0.9)
    out.feed[rows] = np.sign(levels) * (span.dead + 0.45 * abs(levels))


def _chirp(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    out.mode[rows] = PULLED
    low, high = 0.3, rng.uniform(5, 12)
    phase = 2 * np.pi * t[-1] * low / np.log(high / low) * ((high / low) ** (t / t[-1]) - 1)
    frequency = low * (high / low) ** (t / t[-1])
    size = np.minimum(0.25 + 0.12 * frequency, 0.9)
    out.feed[rows] = size * np.sin(phase)


def _multisine(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    out.mode[rows] = PULLED
    wave, _ = _sines(t, 0.4, 9.0, rng, 9)
    out.feed[rows] = 0.85 * wave


def _pulses(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    """Full openings of some tens of milliseconds, closed between them."""
    out.mode[rows] = TURNED
    feed, at, side = np.zeros(len(t)), rng.uniform(0.2, 0.6), 1.0
    while at < t[-1]:
        wide = rng.uniform(0.03, 0.12)
        feed[(t >= at) & (t < at + wide)] = side * rng.choice([0.6, 1.0])
        at += wide + rng.uniform(0.25, 1.4)
        side = -side if rng.random() < 0.85 else side
    out.feed[rows] = feed


def _strokes(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    """Moves from place to place of least jerk, and rests between them."""
    goal, speed = np.full(len(t), span.middle), np.zeros(len(t))
    at, place = rng.uniform(0.1, 0.4), span.middle
    while at < t[-1]:
        there = span.middle + span.travel * rng.uniform(0.3, 1.0) * (-1 if place > span.middle else 1)
        longer = 1.875 * abs(there - place) / (span.fastest * rng.uniform(0.15, 0.6))
        s = np.clip((t - at) / longer, 0.0, 1.0)
        after = t >= at
        goal[after] = place + (there - place) * (s**3 * (10 - 15 * s + 6 * s**2))[after]
        speed[after] = (there - place) / longer * (30 * s**2 * (1 - s) ** 2)[after]
        at += longer + rng.uniform(0.15, 0.8)
        place = there
    out.goal[rows], out.speed[rows], out.feed[rows] = goal, speed, _forward(speed, span)


def _binary(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    """The valve thrown from side to side by a pseudo-random binary sequence."""
    out.mode[rows] = PULLED
    clock = rng.uniform(0.05, 0.12)
    sides = np.where(rng.random(int(t[-1] / clock) + 2) < 0.5, -1.0, 1.0)
    out.feed[rows] = (span.dead + rng.uniform(0.3, 0.55)) * sides[(t / clock).astype(int)]


def _hand(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    """A joystick: slow, never twice the same, let go now and then."""
    out.mode[rows] = PULLED
    knots = np.arange(0.0, t[-1] + 1.0, 0.35)
    wave = np.interp(t, knots, rng.normal(0.0, 0.45, len(knots)))
    wide = max(3, round(0.18 / float(np.median(np.diff(t)))))
    smooth = np.convolve(wave, np.ones(wide) / wide, "same")
    out.feed[rows] = np.clip(np.where(abs(smooth) < 0.06, 0.0, smooth), -0.95, 0.95)


def _holds(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    """Moves, and a valve closed for a second or three after each."""
    wish, at, moving = np.full(len(t), span.middle), 0.0, True
    closed = np.zeros(len(t), bool)
    place = span.middle
    while at < t[-1]:
        longer = rng.uniform(0.5, 0.9) if moving else rng.uniform(1.0, 2.8)
        inside = (t >= at) & (t < at + longer)
        if moving:
            place = span.middle + span.travel * rng.uniform(-1, 1)
        wish[inside], closed[inside] = place, not moving
        at += longer
        moving = not moving
    goal, speed = _soft(t, wish, span)
    out.goal[rows], out.speed[rows] = goal, speed
    out.feed[rows] = np.where(closed, 0.0, _forward(speed, span))
    out.mode[rows] = np.where(closed, FED, POSITION)


def _forces(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    out.mode[rows] = FORCES
    wave, _ = _sines(t, 0.3, 2.5, rng)
    out.goal[rows] = span.force + span.reach * (0.6 * wave + 0.25 * _held(t, rng, 0.6, 1.5))
    out.speed[rows] = span.middle


def _switched(out: Program, rows: slice, t: Array, span: Range, rng: np.random.Generator) -> None:
    out.mode[rows] = SWITCHED
    out.goal[rows] = _held(t, rng, 0.7, 2.2) * span.travel + span.middle


PROGRAMS: dict[str, Callable[[Program, slice, Array, Range, np.random.Generator], None]] = {
    "tracking": _tracking,
    "triangles": _triangles,
    "places": _places,
    "steps": _steps,
    "chirp": _chirp,
    "multisine": _multisine,
    "pulses": _pulses,
    "holds": _holds,
    "forces": _forces,
    "switched": _switched,
    "strokes": _strokes,
    "binary": _binary,
    "hand": _hand,
}


def _held(t: Array, rng: np.random.Generator, low: float, high: float) -> Array:
    """Return levels within -1..1, each held for between low and high seconds."""
    edges = np.cumsum(rng.uniform(low, high, int(t[-1] / low) + 2))
    levels = rng.uniform(-1, 1, len(edges) + 1)
    return levels[np.searchsorted(edges, t, side="right")]


def _forward(speed: Array, span: Range) -> Array:
    """Return the command that about gives this speed, over the dead band."""
    return np.where(speed == 0, 0.0, np.sign(speed) * span.dead * 0.8) + speed / span.fastest


def gains(span: Range, stiffness_mass: float, lag: float, noise: float) -> Array:
    """Return the gains that a careful owner would set.

    Args:
        span: What may be asked of the machine.
        stiffness_mass: Moved mass [kg], an inertia's seen at the piston.
        lag: Of the valve [s].
        noise: Of the position sensor, in joint units.
    """
    out = np.zeros(GAINS)
    pace = min(0.3 * span.natural, 0.22 / max(lag, 0.004), 14.0)
    out[0] = pace / span.fastest
    out[1] = 0.35 / span.fastest
    damping = min(0.5, 0.1 / max(lag * span.natural, 0.05))
    out[2] = 2 * damping / (span.fastest * span.natural * stiffness_mass)
    out[3] = 0.35 / span.reach
    out[4] = 1.5 / span.reach
    out[5] = 1.2 * span.reach / span.travel
    out[6] = 0.5 / span.travel
    out[7] = max(0.08 * span.travel, 4 * noise, 0.35 * lag * span.fastest)
    out[8] = lag + 1.5 / span.natural
    out[9] = 0.6 * span.travel
    return out
