"""Which rows make a clock increase, and what is said of the others."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from exo_sim.errors import RecordingError
from exo_sim.recording.clock_repair import in_order

STEADY: NDArray[np.float64] = np.asarray(np.arange(20) * 0.01, dtype=np.float64)


def kept(time: NDArray[np.float64]) -> tuple[NDArray[np.float64], list[str], tuple[float, ...]]:
    rows, findings, breaks = in_order("a.csv", time)
    return time[rows], [one.says for one in findings], breaks


def test_an_increasing_clock_is_left_alone() -> None:
    rows, findings, breaks = in_order("a.csv", STEADY)
    assert rows == slice(None) and findings == [] and breaks == ()


def test_rows_without_a_time_are_dropped() -> None:
    time = STEADY.copy()
    time[[3, 7]] = np.nan
    found, says, _ = kept(time)
    assert len(found) == 18 and np.isfinite(found).all() and "2 rows, first row 4" in says[0]


def test_a_clock_that_runs_backwards_is_turned_round() -> None:
    found, says, _ = kept(STEADY[::-1].copy())
    np.testing.assert_array_equal(found, STEADY)
    assert "backwards" in says[0]


def test_of_a_clock_that_stands_still_the_first_row_of_each_counts() -> None:
    time = STEADY.copy()
    time[5:8] = time[5]
    found, says, _ = kept(time)
    assert len(found) == 18 and (np.diff(found) > 0).all() and "stands still in 2 rows, first row 7" in says[0]


def test_a_short_step_back_is_dropped_and_nothing_is_predicted_across_it() -> None:
    time: NDArray[np.float64] = np.asarray(np.arange(100) * 0.01, dtype=np.float64)
    time[50:53] -= 0.03
    found, says, breaks = kept(time)
    assert (np.diff(found) > 0).all() and "steps back once" in says[0]
    assert breaks == (time[53],)


def test_of_two_recordings_in_one_file_the_longer_is_kept() -> None:
    found, says, breaks = kept(np.concatenate([STEADY[:8], STEADY]))
    np.testing.assert_array_equal(found, STEADY)
    assert "several recordings" in says[0] and breaks == ()


def test_a_clock_of_too_few_digits_is_asked_about() -> None:
    _, says, _ = kept(1.7e9 + np.repeat(np.arange(20) * 0.01, 5))
    assert says == [
        '"time" stands still in 80 rows, first row 2 (1700000000 s); only the first of each was kept; was it written with too few digits?'
    ]


def test_a_clock_without_numbers_is_refused() -> None:
    with pytest.raises(RecordingError, match=r'"a\.csv": column "time" holds no numbers'):
        in_order("a.csv", np.full(5, np.nan))
