"""Progress of long work: a bar on stderr where that is a terminal, silence elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from typing import Any, TypeVar

T = TypeVar("T")


class Bar:
    """A bar that is moved by hand; a context manager.

    Args:
        total: How much there is to do, in `unit`.
        words: What is going on, in a few words.
        unit: What is counted: "s", "trial".
        quiet: Show nothing even on a terminal.
    """

    def __init__(self, total: float, words: str, unit: str = "it", quiet: bool = False) -> None:
        self._bar: Any = None
        if not quiet and sys.stderr.isatty():
            from tqdm import tqdm

            self._bar = tqdm(
                total=total,
                desc=words,
                unit=unit,
                file=sys.stderr,
                leave=False,
                dynamic_ncols=True,
                delay=0.5,
                bar_format="{desc} {percentage:3.0f}% |{bar}| {n:.4g}/{total:.4g} {unit} [{elapsed}<{remaining}]",
            )

    def to(self, done: float) -> None:
        """Show that `done` of the total is done."""
        if self._bar is not None:
            self._bar.update(done - self._bar.n)

    def advance(self, amount: float = 1.0) -> None:
        """Show that `amount` more is done."""
        if self._bar is not None:
            self._bar.update(amount)

    def close(self) -> None:
        """Take the bar away."""
        if self._bar is not None:
            self._bar.close()

    def __enter__(self) -> Bar:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


def each(items: Iterable[T], words: str, *, total: int, unit: str = "it", quiet: bool = False) -> Iterator[T]:
    """Go through `items` with a bar."""
    with Bar(total, words, unit, quiet) as bar:
        for item in items:
            yield item
            bar.advance()
