"""How long machine code has been compiled for in this process; what is taken from the kept code takes next to nothing."""

from __future__ import annotations

from numba.core import event

_listener = event.TimingListener()  # type: ignore[no-untyped-call]
event.register("numba:compile", _listener)  # type: ignore[no-untyped-call]


def compiled_seconds() -> float:
    """Return the time so far, since this was imported [s]."""
    return float(_listener.duration) if _listener.done else 0.0  # type: ignore[no-untyped-call]
