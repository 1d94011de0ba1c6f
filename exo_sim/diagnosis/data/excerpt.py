"""Long recordings: evenly spread blocks of a run stand for all of it where predictions are fitted.

What is fitted is known to a fraction of a per cent after minutes; an hour of samples would only make every prediction sixty times as
long. The held-out time is never thinned out like that.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.policy.budgets import BLOCKS, LEAD, LONGEST_FITTED, MOST_FITTED, MOST_IN_ONE_RUN, WORTH_CUTTING
from exo_sim.diagnosis.policy.recordings import FEWEST_TO_FIT

Array = NDArray[np.float64]


def excerpts(runs: Sequence[CylinderRun], split: Split) -> tuple[list[CylinderRun], Split]:
    """Return the runs, or of long ones blocks that together hold at most `MOST_FITTED` samples; a run at rest keeps one of so many.

    Nobody knows how warm the gas is where a block begins: its first seconds are no training time of the split that is returned.
    """
    total = sum(len(run.time) for run in runs)
    if total <= WORTH_CUTTING * MOST_FITTED:
        return list(runs), split
    kept = [_excerpt(run, max(1, MOST_FITTED * len(run.time) // total)) for run in runs]
    spans = dict(split.validation)
    for run in kept:
        begun = [float(run.time[first]) for first in run.breaks if not run.at_rest]
        spans[run.recording] = (*spans.get(run.recording, ()), *((start, start + LEAD) for start in begun if start > run.time[0]))
    return kept, Split(split.test, spans)


def _excerpt(run: CylinderRun, most: int) -> CylinderRun:
    n = len(run.time)
    if run.at_rest:
        return run.at(np.arange(0, n, -(-n // most)), run.breaks[:1])
    kept = np.flatnonzero((np.arange(n) / n * BLOCKS) % 1.0 < most / n)
    jumps = np.flatnonzero(np.diff(kept) > 1) + 1
    own = np.searchsorted(kept, [index for index in run.breaks if index in kept])
    return run.at(kept, tuple(sorted({0, *(int(i) for i in jumps), *(int(i) for i in own)})))


def spread(time: Array, total: float) -> NDArray[np.bool_]:
    """Return which samples of a balance of forces are fitted, shape (n,): all, or of long recordings evenly spread blocks.

    Args:
        time: Its clock [s].
        total: Length of all recordings together [s].
    """
    share = LONGEST_FITTED / max(total, 1e-9)
    if WORTH_CUTTING * share >= 1.0:
        return np.ones(len(time), dtype=bool)
    whole: NDArray[np.bool_] = ((time - time[0]) / float(np.ptp(time)) * BLOCKS) % 1.0 < share
    return whole


def kept_back(run: CylinderRun, split: Split) -> CylinderRun | None:
    """Return a run; of a long one what its test time needs, with a few seconds before it; None where it has no test time."""
    if len(run.time) <= WORTH_CUTTING * MOST_FITTED or run.at_rest:
        return run
    inside = np.flatnonzero(split.in_test(run.recording, run.time))
    if not inside.size:
        return None
    start = int(np.searchsorted(run.time, run.time[inside[0]] - LEAD))
    return run.part(start, int(inside[-1]) + 1)


def led_to_test(run: CylinderRun, split: Split, total: int) -> CylinderRun:
    """Return a run; where the `total` samples of all are too many for one run, so much of it as ends with its test time."""
    if total <= MOST_IN_ONE_RUN:
        return run
    inside = np.flatnonzero(split.in_test(run.recording, run.time))
    stop = int(inside[-1]) + 1 if inside.size else len(run.time)
    return run.part(max(0, stop - max(1, MOST_IN_ONE_RUN * len(run.time) // total)), stop)


def training_part(run: CylinderRun, split: Split) -> CylinderRun | None:
    """Return a run up to the end of its training time, for nothing later is predicted; None where it has none."""
    usable = np.flatnonzero(split.in_training(run.recording, run.time))
    return run.until(int(usable[-1]) + 1) if usable.size > FEWEST_TO_FIT else None
