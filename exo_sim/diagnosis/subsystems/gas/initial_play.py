"""Where the play of a valve stands when a recording begins.

No sensor says it: until the command has once passed through the whole loop, the spool may be anywhere in it behind the command. What the
pressures do first tells it, and each prediction begins with it there: it belongs to the recording, not to the machine.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs

Array = NDArray[np.float64]

#: The play is looked for in no more than the first seconds: what the gas does later shows what else is missing [s]; asserted, a window.
LOOKED_FOR = 1.2
#: Fewest samples that can show it.
FEWEST = 5
#: Half the span of the three places that are tried around the best so far, as a share of half the loop. With two spans, the last 0.3, a
#: cylinder of 0.2 m is missed by up to 6 % of what it is missed by without its hysteresis, with these by less than 3 %.
SPANS = (1.0, 0.35, 0.1)


def begun_plays(
    feed: GasInputs, width: float, together: bool, predicted: Callable[[int, tuple[float, float]], Array]
) -> tuple[float, float]:
    """Return where the plays towards both chambers stand when a run begins, as a share of half the loop from its middle.

    Args:
        feed: Inputs of the run.
        width: Of the whole loop; without one they stand in the middle, as where the command passes through it at once.
        together: Whether one spool serves both chambers.
        predicted: How many of the first samples, and where the plays stand, to the pressures that are predicted, shape (m, 2) [Pa].
    """
    shown = max(samples_of_open_play(feed.time, command, width) for command in (feed.command, feed.command_2)) if width > 0.0 else 0
    if shown < FEWEST:
        return 0.0, 0.0

    def errors(one: float, other: float) -> Array:
        pairs = zip(feed.run.pressure, predicted(shown, (one, other)).T, strict=True)
        return np.array([0.0 if measured is None else _spread(measured[:shown] - seen) for measured, seen in pairs])

    return initial_play(errors, together)


def _spread(errors: Array) -> float:
    """Return the sum of squares about the mean: zeros of sensors, and what a window begins with, say nothing of the play."""
    known = errors[np.isfinite(errors)]
    return float(np.sum((known - known.mean()) ** 2)) if known.size else 0.0


def samples_of_open_play(time: Array, command: Array, width: float) -> int:
    """Return how many of the first samples show where a play stood in the beginning.

    Args:
        time, command: Shape (n,).
        width: Of the whole loop.
    """
    first = command[: int(np.searchsorted(time, time[0] + LOOKED_FOR))]
    passed = np.maximum.accumulate(first) - np.minimum.accumulate(first)
    return int(np.searchsorted(passed, width))  # `passed` never falls


def initial_play(errors: Callable[[float, float], Array], together: bool) -> tuple[float, float]:
    """Return where the plays towards both chambers stand, as a share of half the loop from its middle.

    Args:
        errors: Places of both to the sum of squared errors of each chamber's pressure in the first samples, shape (2,).
        together: Whether one spool serves both chambers.
    """
    best = (0.0, 0.0)
    for span in SPANS:
        middle = [min(max(place, span - 1.0), 1.0 - span) for place in best]
        around = (-span, 0.0, span)
        tried = np.array([errors(middle[0] + by, middle[1] + by) for by in around])
        if together:
            tried = np.repeat(tried.sum(axis=1, keepdims=True), 2, axis=1)
        best = middle[0] + _vertex(tried[:, 0], span), middle[1] + _vertex(tried[:, 1], span)
    return best


def _vertex(errors: Array, span: float) -> float:
    """Return where a parabola through the errors at three places, `span` apart, is least between them; the middle where all are alike."""
    left, here, right = map(float, errors)
    bend = left - 2.0 * here + right
    if bend > 0.0:
        return min(max(0.5 * span * (left - right) / bend, -span), span)
    return span * float(np.sign(left - right))
