"""Blocks of long recordings: spread over all of it, no more than the most, and what is short stays whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.excerpt import excerpts, kept_back, led_to_test, spread
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.policy.budgets import BLOCKS, LEAD, LONGEST_FITTED, MOST_FITTED, MOST_IN_ONE_RUN


def run(count: int, moving: bool = True) -> CylinderRun:
    time = np.asarray(1e-3 * np.arange(count), dtype=np.float64)
    length = 0.05 + 0.01 * np.sin(time) if moving else np.full(count, 0.05)
    return CylinderRun(
        "long", "piston", time, np.zeros(count), length, np.zeros(count), (1e5 + time, None), None, None, None, None, True, (1.0, 1.0),
        (0, count // 2),
    )  # fmt: skip


def test_what_is_short_stays_as_it_is() -> None:
    short = run(int(1.2 * MOST_FITTED))
    nothing = Split({})
    assert excerpts([short], nothing) == ([short], nothing) and kept_back(short, Split({})) is short
    assert spread(short.time, 1.2 * LONGEST_FITTED).all()


def test_blocks_of_a_long_run_are_spread_over_it_and_begin_anew() -> None:
    (part,), split = excerpts([run(4 * MOST_FITTED)], Split({}))
    assert 0.99 * MOST_FITTED < len(part.time) <= 1.01 * MOST_FITTED
    gaps = np.flatnonzero(np.diff(part.time) > 2e-3) + 1
    assert len(gaps) == BLOCKS - 1 and set(gaps) <= set(part.breaks) and part.breaks[0] == 0
    assert part.time[-1] > 0.9 * 4e-3 * MOST_FITTED
    for first, last in zip(part.breaks, [*part.breaks[1:], len(part.time)], strict=True):
        assert np.ptp(np.diff(part.time[first:last])) < 1e-9
        cold = (part.time > part.time[first]) & (part.time < part.time[first] + LEAD)
        assert split.in_training("long", part.time[cold]).any() == (first == 0)
    assert split.in_training("long", part.time).mean() == pytest.approx(1.0 - LEAD * (BLOCKS - 1) / (1e-3 * MOST_FITTED), abs=0.02)


def test_several_runs_share_the_most_and_one_at_rest_keeps_one_of_so_many() -> None:
    long = run(2 * MOST_FITTED)
    assert sum(len(part.time) for part in excerpts([long, replace(long, recording="other")], Split({}))[0]) <= 1.01 * MOST_FITTED
    (still,), _ = excerpts([run(3 * MOST_FITTED, moving=False)], Split({}))
    assert len(still.time) == MOST_FITTED and np.ptp(np.diff(still.time)) < 1e-9 and still.breaks == (0,)


def test_the_test_time_of_a_long_run_is_whole() -> None:
    long = run(3 * MOST_FITTED)
    part = kept_back(long, Split({"long": ((100.0, 130.0),)}))
    assert part is not None
    assert (part.time[0], part.time[-1]) == pytest.approx((100.0 - LEAD, 130.0))
    assert kept_back(long, Split({"other": ((1.0, 2.0),)})) is None


def test_of_a_long_balance_the_longest_is_fitted() -> None:
    time = np.arange(0.0, 4.0 * LONGEST_FITTED, 0.01)
    kept = spread(time, 4.0 * LONGEST_FITTED)
    assert kept.mean() == pytest.approx(0.25, abs=0.01)
    assert [part.any() for part in np.array_split(kept, BLOCKS)] == [True] * BLOCKS


def test_one_run_of_a_long_recording_leads_to_the_end_of_its_test_time() -> None:
    long = run(MOST_IN_ONE_RUN + 1000)
    assert led_to_test(long, Split({}), MOST_IN_ONE_RUN) is long
    part = led_to_test(long, Split({"long": ((300.0, 500.0),)}), 2 * MOST_IN_ONE_RUN)
    assert part.time[-1] == pytest.approx(500.0) and len(part.time) == pytest.approx(0.5 * MOST_IN_ONE_RUN, rel=0.01)
    early = led_to_test(long, Split({"long": ((0.0, 1.0),)}), 2 * MOST_IN_ONE_RUN)
    assert early.time[0] == 0.0 and early.time[-1] == pytest.approx(1.0)
