"""Linear algebra in one thread: inside, and not any longer than that."""

from collections.abc import Iterator
from threading import Event, Thread

import numpy as np
import pytest
from threadpoolctl import ThreadpoolController, threadpool_info, threadpool_limits

from exo_sim.linear_algebra import in_one_thread


def threads() -> set[int]:
    """Return how many threads each loaded BLAS may use; one that is built without any, as Cantera's, always has one."""
    np.ones((2, 2)) @ np.ones((2, 2))
    blas = [one for one in threadpool_info() if one["user_api"] == "blas"]
    return {one["num_threads"] for one in blas if one.get("threading_layer") != "disabled"}


def test_the_function_has_one_thread_and_its_caller_those_that_he_had() -> None:
    with threadpool_limits(limits=2, user_api="blas"):
        assert threads() == {2}
        assert in_one_thread(threads)() == {1}
        assert threads() == {2}


def test_they_come_back_after_an_error_too() -> None:
    def fails(value: int) -> int:
        raise ValueError(str(value))

    with threadpool_limits(limits=2, user_api="blas"):
        with pytest.raises(ValueError, match="7"):
            in_one_thread(fails)(7)
        assert threads() == {2}


@pytest.fixture
def two() -> Iterator[None]:
    """Let every BLAS have two threads, and any thread set another number: to threadpoolctl a block that sets them is its thread's."""
    blas = ThreadpoolController().select(user_api="blas")
    limit = blas.limit(limits=2)
    with blas.limit(limits=None):
        pass
    yield
    limit.restore_original_limits()
    with blas.limit(limits=None):
        pass


class Caller:
    """A function in one thread that goes on until it is told to end, in a thread of its own that lives longer than that."""

    def __init__(self) -> None:
        self._entered, self._ends, self._left, self._dies = (Event() for _ in range(4))
        self._thread = Thread(target=self._live, daemon=True)
        self._thread.start()
        assert self._entered.wait(10.0)

    def _live(self) -> None:
        in_one_thread(self._run)()
        self._left.set()
        self._dies.wait(10.0)

    def _run(self) -> None:
        self._entered.set()
        self._ends.wait(10.0)

    def end(self) -> None:
        self._ends.set()
        assert self._left.wait(10.0)

    def die(self) -> None:
        self._dies.set()
        self._thread.join(10.0)


@pytest.mark.usefixtures("two")
@pytest.mark.parametrize("order", [(0, 1), (1, 0)], ids=["who began first ends first", "who began first ends last"])
def test_callers_in_threads_have_one_thread_until_the_last_has_ended(order: tuple[int, int]) -> None:
    """Also where the thread that set the limit lives on without it: to threadpoolctl it might be that one's for good."""
    lived = list[Caller]()
    for _ in range(2):
        callers = Caller(), Caller()
        lived += callers
        assert threads() == {1}
        callers[order[0]].end()
        assert threads() == {1}
        callers[order[1]].end()
        assert threads() == {2}
    for caller in lived:
        caller.die()
