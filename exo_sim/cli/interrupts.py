"""Ctrl-C wherever it meets the program: in a library's callback or while code is compiled, it still ends the verb, and as an interrupt."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

#: How long after it was swallowed an interrupt is raised again [s].
_SOON = 0.05


@contextmanager
def noted() -> Iterator[Callable[[], bool]]:
    """Raise each Ctrl-C as ever, and give what says whether one came: a library that was in the middle of something may turn it into
    another error. One that is swallowed by a callback is raised once more.
    """
    came: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        came.append(number)
        signal.default_int_handler(number, frame)

    def unraisable(what: Any) -> None:
        if isinstance(what.exc_value, KeyboardInterrupt):
            again = threading.Timer(_SOON, _raised_again)  # here it would be swallowed as well
            again.daemon = True
            again.start()
        else:
            shown(what)

    if threading.current_thread() is not threading.main_thread() or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield lambda: bool(came)  # somebody else looks after it, or it is to be ignored
        return
    shown = sys.unraisablehook
    signal.signal(signal.SIGINT, note)
    sys.unraisablehook = unraisable
    try:
        yield lambda: bool(came)
    finally:
        sys.unraisablehook = shown
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _raised_again() -> None:
    """Interrupt the main thread as the terminal does: a signal of its own also ends what waits in the system."""
    main = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and main is not None:
        signal.pthread_kill(main, signal.SIGINT)
    else:
        _thread.interrupt_main()
