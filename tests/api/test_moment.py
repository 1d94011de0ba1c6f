"""Time between moments, without that of compiling."""

from __future__ import annotations

import time

import numba

from exo_sim.api.moment import Moment
from exo_sim.api.simulated import times_of
from exo_sim.cli.printing import compiling
from exo_sim.physics.compile_time import compiled_seconds


def test_time_of_compiling_is_counted_apart() -> None:
    before = Moment.now()
    begun = time.perf_counter()
    numba.njit(lambda x: x * 2.0 + 1.0)(1.0)
    taken = time.perf_counter() - begun
    after = Moment.now()
    compiled = after.compiled - before.compiled
    assert 0.0 < compiled <= taken and compiled_seconds() == after.compiled
    assert before.until(after) <= after.at - before.at - compiled
    times = times_of(before, before)
    assert times["compiled_s"] >= compiled and times["prepared_s"] == 0.0


def test_a_first_run_says_so_and_a_later_one_nothing() -> None:
    assert compiling(32.64) == ", beside 32.6 s of compiling"
    assert compiling(0.01) == ""
