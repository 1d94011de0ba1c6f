"""Threads: outcomes in the order of the items, and no level waits for the other's threads."""

from __future__ import annotations

import threading

import pytest

from exo_sim.diagnosis.estimation.threads import SERIAL, Threads


@pytest.mark.parametrize("count", [1, 2, 5])
def test_outcomes_come_in_the_order_of_the_items(count: int) -> None:
    with Threads(count) as threads:
        assert threads.fits(lambda one: one**2, range(20)) == [one**2 for one in range(20)]
        assert threads.predictions(lambda one: -one, range(20)) == [-one for one in range(20)]


def test_fits_that_all_wait_for_predictions_end() -> None:
    gate = threading.Barrier(2, timeout=300.0)

    def fit(one: int) -> int:
        gate.wait()  # both threads of this level are taken now
        return sum(threads.predictions(lambda other: one + other, range(4)))

    with Threads(2) as threads:
        assert threads.fits(fit, range(4)) == [4 * one + 6 for one in range(4)]


def test_alone_works_in_the_thread_that_asks() -> None:
    assert set(SERIAL.fits(lambda _: threading.get_ident(), range(4))) == {threading.get_ident()}


def test_an_error_comes_through() -> None:
    def fit(one: int) -> int:
        raise ZeroDivisionError(one)

    with Threads(2) as threads, pytest.raises(ZeroDivisionError):
        threads.fits(fit, range(4))


def test_what_outlives_the_pools_runs_serially() -> None:
    with Threads(2) as threads:
        threads.fits(str, range(4))
    assert threads.fits(str, range(3)) == ["0", "1", "2"]
    assert threads.predictions(str, range(3)) == ["0", "1", "2"]
