"""Linear algebra in one thread: matrices are small here, and how many threads share a product decides its last bits.

Searches and rehearsals go on with what costs less, so such bits may send them another way: a machine with a free ankle cost its wearer
636 W on one core and 729 W on two. And threads that wait for each other cost processor time.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from threading import Lock
from types import TracebackType
from typing import Any, ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


class _OneThread:
    """One thread for BLAS from when the first caller enters until the last one has left, in whatever threads they are."""

    def __init__(self) -> None:
        self._lock, self._inside = Lock(), 0
        self._limit: Any = None

    def __enter__(self) -> None:
        with self._lock:
            if self._inside == 0:
                self._blas = ThreadpoolController().select(user_api="blas")
                self._limit = self._blas.limit(limits=1)
                self._let_others_set()
            self._inside += 1

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        with self._lock:
            self._inside -= 1
            if self._inside == 0:
                self._limit.restore_original_limits()
                self._let_others_set()

    def _let_others_set(self) -> None:
        """Have threadpoolctl forget that this thread set a limit: 3.8 lets no other thread set one until a block of that one ends."""
        with self._blas.limit(limits=None):
            pass


_one_thread = _OneThread()


def in_one_thread(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Make a function run with one thread in every BLAS that is loaded, whatever the caller has before and after.

    Such a limit is the whole process': from when the first function of this kind begins until none runs any more, in any thread, all of
    the process' BLAS has one thread. Then it has again what it had before the first. So two callers in threads do not disturb each other,
    and what else the process computes meanwhile has one thread as well.

    A BLAS that is loaded meanwhile has as many threads as it likes, and so has one whose number somebody else sets meanwhile, or holds in
    another thread with threadpoolctl. One that is built with OpenMP counts by thread: there only the first caller's thread is limited, and
    stays so where another one's function ends last.
    """

    @wraps(function)
    def call(*args: Arguments.args, **named: Arguments.kwargs) -> Result:
        with _one_thread:
            return function(*args, **named)

    return call
