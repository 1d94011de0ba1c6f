"""Progress of long work: a bar on stderr where that is a terminal, silence elsewhere."""

from __future__ import annotations

import shutil
import sys
import time
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
        at_once: Show it before the first is done, where each takes long; else work of less than half a second shows nothing.
    """

    def __init__(self, total: float, words: str, unit: str = "it", quiet: bool = False, at_once: bool = False) -> None:
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
                delay=0.0 if at_once else 0.5,
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


class Stages:
    """Says what is going on, one line that the next one replaces; a context manager.

    Args:
        quiet: Show nothing even on a terminal.
    """

    def __init__(self, quiet: bool = False) -> None:
        self._shown = not quiet and sys.stderr.isatty()
        self._begun = time.monotonic()

    def say(self, words: str) -> None:
        """Show what is going on now, and for how long it all has been."""
        if self._shown:
            line = f"{time.monotonic() - self._begun:4.0f} s  {words}"
            print("\r\x1b[2K" + line[: shutil.get_terminal_size().columns - 1], end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        """Take the line away."""
        if self._shown:
            print("\r\x1b[2K", end="", file=sys.stderr, flush=True)

    def __enter__(self) -> Stages:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


def each(
    items: Iterable[T], words: str, *, total: int, unit: str = "it", quiet: bool = False, at_once: bool = False
) -> Iterator[T]:
    """Go through `items` with a bar."""
    with Bar(total, words, unit, quiet, at_once) as bar:
        for item in items:
            yield item
            bar.advance()
