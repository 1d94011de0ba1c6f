"""Commands as they reach a valve: after its dead times, over the steps of a prediction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.policy.recordings import NO_PART, SWITCHED
from exo_sim.physics.effects import valve_lag

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ArrivedCommands:
    """Commands as they reach the valve over the step after each sample.

    Attributes:
        command: Towards both chambers, mean over the first part of the step and over the rest, shape (n, 4): 1, 2, 1, 2.
        first: Length of the first part [s], shape (n,); 0 where the step is one part, over which the first mean holds.
    """

    command: Array
    first: Array


def let_go_later(time: Array, commands: Array, closing: float, reversal: float) -> tuple[Array, Array]:
    """Return held commands, shape (n, m), that close a valve `closing` seconds later than they open it: when they change, and to what."""
    later = time + closing
    there = np.union1d(time, later)

    def held(clock: Array) -> Array:
        return commands[np.clip(np.searchsorted(clock, there, side="right") - 1, 0, len(time) - 1)]

    found = np.empty((there.size, commands.shape[1]))
    valve_lag.all_arrived(held(time), held(later), closing, reversal, found)
    return there, found


def late_commands(time: Array, commands: Array, delay: float, closing: float = 0.0, reversal: float = 0.0) -> ArrivedCommands:
    """Return held commands, shape (n, 2), that arrive `delay` seconds late, and `closing` later still where they close the valve.

    How the spool gets straight from one side to the other is `reversal`, of `valve_lag.REVERSALS`.

    A valve that is switched over in the middle of a step passes neither what it does at the mean command nor, behind a dead-band,
    anything like it: the step has two parts, divided where the largest change arrives.
    """
    n = len(time)
    if delay == 0.0 and closing == 0.0:
        return ArrivedCommands(np.hstack([commands, commands]), np.zeros(n))
    # means are mirrored as commands are, unless a spring acts one way only; where one spool serves both chambers only the first counts
    mirrored = np.array_equal(commands[:, 1], -commands[:, 0]) and (closing == 0.0 or reversal == 0.0)
    held = commands[:, :1] if mirrored else commands
    changed, held = (time, held) if closing == 0.0 else let_go_later(time, held, closing, reversal)
    sides = [np.ascontiguousarray(side) for side in held.T]
    edges = np.append(time, 2 * time[-1] - time[-2]) - delay
    steps = np.diff(changed)
    total = [np.concatenate(([0.0], np.cumsum(side[:-1] * steps))) for side in sides]

    def passed(at: Array) -> list[Array]:
        before, behind = np.minimum(at - changed[0], 0.0), np.maximum(at - changed[-1], 0.0)
        return [np.interp(at, changed, sums) + before * side[0] + behind * side[-1] for sums, side in zip(total, sides, strict=True)]

    at_edges = passed(edges)
    first = np.zeros(n)
    changes = [np.abs(np.diff(side)) for side in sides]
    change = changes[0] if mirrored else np.maximum(*changes)
    switched = np.flatnonzero(change > SWITCHED)
    switched = switched[np.argsort(change[switched], kind="stable")] + 1  # of several in one step the largest is written last
    step = np.searchsorted(edges, changed[switched], side="right") - 1
    within = (step >= 0) & (step < n)
    step, switched = step[within], switched[within]
    first[step] = changed[switched] - edges[step]
    whole = np.diff(edges)
    first[(first < NO_PART * whole) | (first > (1.0 - NO_PART) * whole)] = 0.0
    parts = np.flatnonzero(first)
    between = passed(edges[parts] + first[parts])
    arrived = np.empty((n, 4))
    for column, (edge, middle) in enumerate(zip(at_edges, between, strict=True)):
        early = np.diff(edge) / whole
        late = early.copy()
        early[parts] = (middle - edge[parts]) / first[parts]
        late[parts] = (edge[parts + 1] - middle) / (whole - first)[parts]
        arrived[:, column], arrived[:, column + 2] = early, late
    if mirrored:
        arrived[:, 1::2] = -arrived[:, 0::2]
    return ArrivedCommands(arrived, first)
