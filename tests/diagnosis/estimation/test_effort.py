"""Predicted samples are counted."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

from exo_sim.diagnosis.estimation.effort import Effort


def test_threads_count_together() -> None:
    effort = Effort()
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(effort.add, [3] * 1000))
    assert effort.samples == 3000
