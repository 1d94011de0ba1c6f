"""Means over a stride at each phase, once it is over."""

from __future__ import annotations

import numpy as np

from exo_sim.control.machine_dynamics import PHASES
from exo_sim.control.stride_means import StrideMeans


def test_a_stride_that_is_over_gives_its_means_and_one_with_gaps_none() -> None:
    means, found = StrideMeans(2), []
    for step in range(4 * PHASES + 2):
        phase = 0.5 * step / PHASES
        over = means.take(phase, np.array([np.floor(phase), step % 2]))
        found += [over] if over is not None else []
    assert len(found) == 2
    for stride, table in enumerate(found):
        np.testing.assert_array_equal(table, [[stride, 0.5]] * (PHASES - 1) + [[stride, 0.5]])
    means.forget()
    assert means.take(7.0, np.zeros(2)) is None and means.take(8.0, np.zeros(2)) is None
