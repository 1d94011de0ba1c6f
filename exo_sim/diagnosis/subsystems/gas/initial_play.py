"""Where the play of a valve stands when a recording begins.

No sensor says it: until the command has once passed through the whole loop, the spool may be anywhere in it behind the command. What the
pressures do first tells it, and each prediction begins with it there: it belongs to the recording, not to the machine.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs

Array = NDArray[np.float64]

#: The play is looked for in no more than the first seconds: what the gas does later shows what else is missing [s]; asserted, a window.
LOOKED_FOR = 1.2
#: Fewest samples that can show it.
FEWEST = 5
#: How many places are predicted: the ends of the loop and its middle, then where a parabola through the three nearest, sample by sample,
#: leaves least. 64 plays of whole machine X1043 and a stranger's W6: all 64 are missed by no more than 0.5 % more than at the best of 41
#: places, with four places by 2.5 %; with nine, of which only the sums of squares were looked at, by 1.3 %.
MOST_PREDICTED = 5
#: Where such parabolas are compared, as shares of half the loop from its middle.
_PLACES = np.linspace(-1.0, 1.0, 401)
#: What differs by less of the greatest sum of squares is as good: of such places that nearest the middle counts.
_ALIKE = 1e-9
#: Places of both plays, as shares of half the loop from its middle.
Places = tuple[float, float]


def begun_plays(feed: GasInputs, width: float, together: bool, predicted: Callable[[int, Places], Array]) -> Places:
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

    measured = np.stack([np.full(shown, np.nan) if side is None else side[:shown] for side in feed.run.pressure], axis=1)
    return initial_play(lambda one, other: measured - predicted(shown, (one, other)), together)


def samples_of_open_play(time: Array, command: Array, width: float) -> int:
    """Return how many of the first samples show where a play stood in the beginning.

    Args:
        time, command: Shape (n,).
        width: Of the whole loop.
    """
    first = command[: int(np.searchsorted(time, time[0] + LOOKED_FOR))]
    passed = np.maximum.accumulate(first) - np.minimum.accumulate(first)
    return int(np.searchsorted(passed, width))  # `passed` never falls


def initial_play(errors: Callable[[float, float], Array], together: bool) -> Places:
    """Return where the plays towards both chambers stand, as a share of half the loop from its middle.

    Zeros of sensors, and what a window begins with, say nothing of the play: errors count about their mean.

    Args:
        errors: Places of both to the errors of each chamber's pressure in the first samples, shape (m, 2); NaN where none was measured.
        together: Whether one spool serves both chambers.
    """
    places = [(-1.0, -1.0), (0.0, 0.0), (1.0, 1.0)]
    seen = [errors(*place) for place in places]
    best = _least(places, seen, (0.0, 0.0), together)
    while len(places) < MOST_PREDICTED and best not in places:
        places.append(best)
        seen.append(errors(*best))
        best = _least(places, seen, best, together)
    return best


def _least(places: Sequence[Places], seen: Sequence[Array], near: Places, together: bool) -> Places:
    """Return where errors are least between the three places nearest to others, as far as they go with the place as a parabola."""
    sums = [_between([one[side] for one in places], [one[:, side] for one in seen], near[side]) for side in (0, 1)]
    if together:
        sums = [sums[0] + sums[1]] * 2
    return _lowest(sums[0]), _lowest(sums[1])


def _between(places: Sequence[float], errors: Sequence[Array], near: float) -> Array:
    """Return the sum of squares of errors about their mean at `_PLACES`, infinite beyond the three places nearest to another."""
    own, first = np.unique(places, return_index=True)
    chosen = np.sort(np.argsort(np.abs(own - near), kind="stable")[:3])
    a, b, c = own[chosen]
    known = np.stack([errors[i] for i in first[chosen]])
    known = known[:, np.isfinite(known).all(axis=0)]
    about = known - known.mean(axis=1, keepdims=True) if known.size else known
    x = _PLACES
    shares = np.stack([
        (x - b) * (x - c) / ((a - b) * (a - c)), (x - a) * (x - c) / ((b - a) * (b - c)), (x - a) * (x - b) / ((c - a) * (c - b)),
    ])  # fmt: skip
    return np.where((x >= a) & (x <= c), np.einsum("ig,ij,jg->g", shares, about @ about.T, shares), np.inf)


def _lowest(sums: Array) -> float:
    """Return where a sum of squares at `_PLACES` is least, between two of them by the parabola through its neighbours."""
    finite = sums[np.isfinite(sums)]
    alike = np.flatnonzero(sums <= finite.min() + _ALIKE * finite.max())
    i = int(alike[np.argmin(np.abs(_PLACES[alike]))])
    place = float(_PLACES[i])
    if len(alike) > 1 or not 0 < i < sums.size - 1 or not np.isfinite(sums[i - 1 : i + 2]).all():
        return place
    left, here, right = sums[i - 1 : i + 2]
    bend = left - 2.0 * here + right
    return place + (0.5 * float((left - right) / bend) * float(_PLACES[1] - _PLACES[0]) if bend > 0.0 else 0.0)
