"""What the bench is asked to do: programs of holds, tracking, ramps, steps and chirps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

GIVEN, TRACK, PULLED = 0, 1, 2
PROGRAMS = ("mixed", "tracking", "valve", "holds")


@dataclass(frozen=True)
class Program:
    """One program, one row a tick.

    Attributes:
        mode: How the command is made: `GIVEN`, `TRACK` or `PULLED`, shape (n,).
        goal: Wanted load position [m], shape (n,).
        speed: Its rate [m/s], shape (n,).
        feed: Command given in advance, shape (n,).
    """

    mode: NDArray[np.int64]
    goal: Array
    speed: Array
    feed: Array


def _multisine(t: Array, rng: np.random.Generator, low: float, high: float, count: int) -> Array:
    frequencies = np.geomspace(low, high, count) * rng.uniform(0.9, 1.1, count)
    phases = rng.uniform(0, 2 * np.pi, count)
    weights = 1 / np.sqrt(frequencies / low)
    wave = (weights[:, None] * np.sin(2 * np.pi * frequencies[:, None] * t + phases[:, None])).sum(0)
    return wave / max(np.abs(wave).max(), 1e-12)


def _steps(t: Array, rng: np.random.Generator, dwell: float) -> Array:
    levels = rng.uniform(-1, 1, int(t[-1] / dwell) + 2) if len(t) else np.zeros(0)
    raw = levels[(t / dwell).astype(int)]
    width = max(int(0.06 / max(np.median(np.diff(t)), 1e-6)), 1)
    return np.convolve(np.pad(raw, (width, width), mode="edge"), np.ones(width) / width, "same")[width:-width]


def _triangle(t: Array, period: float) -> Array:
    return 2 / np.pi * np.arcsin(np.sin(2 * np.pi * t / period))


def _chirp(t: Array, low: float, high: float, amplitude: float) -> Array:
    span = max(t[-1], 1e-9)
    return amplitude * np.sin(2 * np.pi * (low * t + 0.5 * (high - low) / span * t**2))


def program(kind: str, time: Array, middle: float, travel: float, opening: float, rng: np.random.Generator) -> Program:
    """Lay out a program.

    Args:
        kind: One of `PROGRAMS`: "mixed" has every piece, "tracking" position control with holds, "valve" given
        commands with
            holds, "holds" mostly closed valves after short moves.
        time: Tick times [s], shape (n,).
        middle, travel: Centre [m] and largest excursion [m] of the motion.
        opening: Valve opening that moves the load at about one travel in a quarter of a second.
        rng: Chance.

    Raises:
        KeyError: `kind` is not a program.
    """
    menus = {
        "mixed": ("sine", "hold", "triangle", "steps", "hold", "chirp", "ramps", "hold", "sine", "pulses", "hold"),
        "tracking": ("sine", "hold", "triangle", "steps", "hold", "sine", "hold"),
        "valve": ("ramps", "hold", "chirp", "pulses", "hold", "ramps", "chirp", "hold"),
        "holds": ("steps", "hold", "hold", "pulses", "hold", "triangle", "hold", "hold"),
    }
    weight = {"sine": 2.5, "hold": 1.3, "triangle": 3.0, "steps": 2.6, "chirp": 2.2, "ramps": 2.4, "pulses": 1.8}
    menu = menus[kind]
    spans = np.array([weight[piece] * rng.uniform(0.8, 1.2) for piece in menu])
    edges = time[0] + np.concatenate(([0], np.cumsum(spans))) / spans.sum() * (time[-1] - time[0])
    n = len(time)
    mode = np.full(n, TRACK, np.int64)
    goal = np.full(n, middle)
    feed = np.zeros(n)
    for piece, left, right in zip(menu, edges[:-1], edges[1:]):
        rows = np.flatnonzero((time >= left) & (time < right + (right == edges[-1])))
        if len(rows) < 3:
            continue
        t = time[rows] - time[rows[0]]
        if piece == "hold":
            mode[rows] = GIVEN
        elif piece == "sine":
            goal[rows] = middle + travel * _multisine(t, rng, 0.35, 2.5, 6)
        elif piece == "triangle":
            goal[rows] = middle + 0.8 * travel * _triangle(t, t[-1] / rng.choice([1.0, 1.5]))
        elif piece == "steps":
            goal[rows] = middle + 0.9 * travel * _steps(t, rng, t[-1] / 4.5)
        else:
            mode[rows] = PULLED
            if piece == "chirp":
                feed[rows] = _chirp(t, 0.6, 5.0, opening)
            elif piece == "ramps":
                feed[rows] = 0.8 * opening * _triangle(t, t[-1] / 3.0)
            else:
                feed[rows] = (
                    opening
                    * np.where(np.sin(2 * np.pi * t / (t[-1] / 3.5)) > 0, 1.0, -1.0)
                    * (np.mod(t, t[-1] / 7) < t[-1] / 14)
                )
    ends = time[-1] - time[0]
    smooth = np.clip((time - time[0]) / min(0.5, 0.1 * ends + 1e-9), 0, 1)
    goal = middle + smooth * (goal - middle)
    speed = np.gradient(goal, time)
    return Program(mode, goal, np.clip(speed, -1.0, 1.0), feed)
