"""The folder that a search keeps its results in: the caller's, or one that lasts as long as its result."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def result_folder(out: str | os.PathLike[str] | None, doing: str) -> Iterator[tuple[Path, tempfile.TemporaryDirectory[str] | None]]:
    """Give the folder, for this process alone, and what keeps it where it is a temporary one.

    Args:
        out: The caller's; None for a temporary one.
        doing: Name of the verb.

    Raises:
        OutputError: it cannot be written, or another process works in it.
    """
    from exo_sim.outputs import alone_in, check_writable

    temporary = tempfile.TemporaryDirectory(prefix=f"exo-sim-{doing}-") if out is None else None
    folder = Path(temporary.name if temporary else out or "")
    check_writable(folder)
    with alone_in(folder, doing):
        yield folder, temporary
