"""The clock: how fast, how even, and where it stops. (Steps back and repeats the reader has mended and reported.)"""

from __future__ import annotations

import numpy as np

from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.health.spans import listed, where
from exo_sim.recording.table import Recording

_TIME = "time"
#: Below this rate, Hz, filling and venting of a small chamber happen between samples.
SLOW = 25.0
#: Spread of intervals, relative to the usual one, that is still called even.
EVEN = 0.05
#: A pause this many intervals long is a gap.
GAP = 10.0


def check(recording: Recording) -> list[Finding]:
    """Look at the clock of a recording."""
    time = recording.time
    steps = np.diff(time)
    if len(steps) < 2:
        return []
    usual = float(np.median(steps))
    found = []
    if usual > 1.0 / SLOW:
        says = (
            f"only {1.0 / usual:.3g} samples a second; whatever the gas does faster than that is not in the recording"
        )
        found.append(Finding(_TIME, "slow clock", says, severity="warning"))
    late = steps > 1.5 * usual
    gaps = np.flatnonzero(steps > max(GAP * usual, 0.05))
    if len(gaps):
        spans = np.stack((gaps, gaps + 2), axis=1)
        rows, times = listed(spans, time)
        longest = float(steps[gaps].max())
        says = (
            f"the clock has gaps, the longest {longest:.4g} s, {where(spans, time)}; nothing is predicted across them"
        )
        found.append(Finding(_TIME, "gap", says, rows, times, severity="warning", use="set aside"))
    lost = int(np.rint(steps[late] / usual - 1.0).sum()) if late.any() else 0
    dropouts = np.flatnonzero(late & (steps <= max(GAP * usual, 0.05)))
    if len(dropouts):
        spans = np.stack((dropouts, dropouts + 2), axis=1)
        rows, times = listed(spans, time)
        grave = len(dropouts) > 0.01 * len(steps)
        says = f"samples are missing: about {lost} of {len(time) + lost}, {where(spans, time)}"
        found.append(Finding(_TIME, "dropouts", says, rows, times, severity="warning" if grave else "info"))
    jitter = float(np.std(steps[~late]) / usual)
    if jitter > EVEN:
        says = (
            f"the clock is uneven: intervals of {usual * 1e3:.4g} ms vary by {100 * jitter:.2g} % (standard deviation)"
        )
        found.append(Finding(_TIME, "jitter", says, severity="info"))
    return found
