"""Predicted samples are counted, and an allowance of them ends what asks."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

from exo_sim.diagnosis.estimation.effort import Allowance, Effort


def test_threads_count_together() -> None:
    effort = Effort()
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(effort.add, [3] * 1000))
    assert effort.samples == 3000


def test_an_allowance_begins_where_it_is_given_and_remembers_whom_it_ended() -> None:
    effort = Effort()
    effort.add(100)
    allowed = Allowance(effort, 10)
    effort.add(10)
    assert allowed.left == 0 and not allowed.is_used_up()
    effort.add(1)
    assert not allowed.stopped  # nobody asked since
    assert allowed.is_used_up() and allowed.stopped
