"""The way of rerun's stream into a file: through a pipe, chunk by chunk.

Rerun's own writing to files waits for ever once a disk is full, and a recording that is kept in memory until it is whole costs more time
than the simulation. So rerun writes into a pipe, and what comes out of it goes to the file here, where a disk may be full.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import rerun as rr

_PIECE = 1 << 20


@contextmanager
def written(stream: rr.RecordingStream, path: Path, footer: bool = True) -> Iterator[None]:
    """Write what the block logs to a stream into a file; it takes nothing after that.

    Args:
        stream: What is logged to.
        path: Where to.
        footer: End the file with a list of its contents.

    Raises:
        OSError: the file cannot be written.
    """
    with path.open("wb", buffering=0) as file:
        if not Path("/dev/fd").exists():  # Windows
            made = stream.memory_recording()
            yield
            file.write(made.drain_as_bytes())
            return
        out, into = os.pipe()
        failures: list[OSError] = []
        copying = threading.Thread(target=_copy, args=(out, file.fileno(), failures), daemon=True)
        _widen(into)
        copying.start()
        try:
            stream.save(f"/dev/fd/{into}", write_footer=footer)
            yield
        finally:
            stream.disconnect()
            os.close(into)
            copying.join()
        if failures:
            raise failures[0]


def _copy(out: int, file: int, failures: list[OSError]) -> None:
    """Copy until the pipe ends; go on reading where nothing more can be written, for rerun waits on a full pipe."""
    piece = bytearray(_PIECE)
    view = memoryview(piece)
    with os.fdopen(out, "rb", buffering=0) as pipe:
        while count := pipe.readinto(piece):
            at = 0
            try:
                while at < count and not failures:
                    at += os.write(file, view[at:count])
            except OSError as error:
                failures.append(error)


def _widen(pipe: int) -> None:
    """Let a pipe hold a piece, where the system lets it: rerun and the copy then change places less often."""
    with suppress(ImportError, AttributeError, OSError):
        import fcntl

        fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, _PIECE)
