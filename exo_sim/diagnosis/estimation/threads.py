"""Threads on two levels: fits in parallel, and inside each fit the predictions for its finite differences."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from types import TracebackType
from typing import TypeVar

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")


class Threads:
    """Thread pools of the same size on both levels; one thread means that everything runs serially.

    The levels have pools of their own, so that a fit that waits for its predictions never holds a thread that they need. What is asked
    after the pools were closed runs serially: models outlive the search that made them.

    Args:
        count: Threads.
    """

    def __init__(self, count: int = 1):
        self._levels: list[ThreadPoolExecutor | None] = [ThreadPoolExecutor(count) if count > 1 else None for _ in range(2)]

    def fits(self, work: Callable[[Item], Outcome], items: Sequence[Item]) -> list[Outcome]:
        """Return the outcome for every item, in their order; `work` may call `predictions`, but not `fits`."""
        return _spread(self._levels[0], work, items)

    def predictions(self, work: Callable[[Item], Outcome], items: Sequence[Item]) -> list[Outcome]:
        """Return the outcome for every item, in their order; `work` may call neither."""
        return _spread(self._levels[1], work, items)

    def __enter__(self) -> Threads:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        for level in reversed(self._levels):  # fits that still run end with their predictions
            if level is not None:
                level.shutdown(cancel_futures=True)
        self._levels = [None, None]


#: No threads: everything runs serially.
SERIAL = Threads()


def _spread(level: ThreadPoolExecutor | None, work: Callable[[Item], Outcome], items: Sequence[Item]) -> list[Outcome]:
    if level is None or len(items) < 2:
        return [work(item) for item in items]
    return list(level.map(work, items))
