"""Stretches of a clock and windows inside them."""

from __future__ import annotations

import numpy as np

from exo_sim.recording.windows import FEWEST_IN_WINDOW, RANGE_SAMPLES, clock_breaks, local_range, stretch_starts, window_starts

TIME = np.arange(1000, dtype=float) * 1e-3


def test_where_the_clock_was_mended_it_has_jumped() -> None:
    mended = (float(TIME[200]),)
    assert clock_breaks(TIME, mended) == stretch_starts(TIME, TIME, mended=mended) == (0, 200)
    assert clock_breaks(TIME, (float(TIME[0]), float(TIME[-1]) + 1.0)) == (0,)  # of a piece that ends before, and one that begins there


def test_a_jump_of_the_clock_begins_a_stretch() -> None:
    assert clock_breaks(TIME) == (0,)
    assert clock_breaks(TIME + 0.5 * (TIME > 0.3995)) == (0, 400)
    assert clock_breaks(TIME + 0.015 * (TIME > 0.3995)) == (0,)  # a few samples late is no jump


def test_both_ends_of_a_hole_begin_one() -> None:
    values = np.zeros(1000)
    values[200:240] = np.nan
    assert stretch_starts(TIME, values, None) == (0, 200, 240)
    values[:] = 0.0
    values[200:205] = np.nan  # shorter than anybody minds
    assert stretch_starts(TIME, values) == (0,)


def test_the_range_around_a_sample() -> None:
    step = np.where(np.arange(1000) < 500, 1e5, 3e5)
    swings = local_range([step, None], 1000)
    assert swings[500] == 2e5 and swings[500 - RANGE_SAMPLES] == 0.0 and swings[500 + RANGE_SAMPLES] == 0.0
    step[700] = np.nan
    assert np.isinf(local_range([step], 1000)[700])


def test_a_window_begins_where_it_is_quiet() -> None:
    restless = np.ones(1000)
    assert window_starts(TIME, 0, 1000, 0.5, restless) == [0, 500]
    restless[540:560] = 0.0
    assert window_starts(TIME, 0, 1000, 0.5, restless) == [0, 540]
    restless[:] = 1.0
    restless[900] = 0.0  # too far
    assert window_starts(TIME, 0, 1000, 0.5, restless) == [0, 500]


def test_on_a_slow_clock_a_window_holds_a_few_samples_however_short_it_is_asked_for() -> None:
    slow = np.asarray(0.5 * np.arange(60), dtype=np.float64)
    assert window_starts(slow, 0, 60, 0.5, np.zeros(60)) == list(range(0, 60, FEWEST_IN_WINDOW))
    assert window_starts(slow, 0, 3, 0.5, np.zeros(60)) == [0]
