"""Writing results: beside first, then renamed into place, so that nothing half-written is ever found under its name."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from exo_sim.errors import OutputError


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Give a path to write to; when the block ends well, the file there takes the place of `path`.

    The folder is made where it is missing. When the block ends in an error or an interrupt, what was at `path` stays as
    it was.
    The path given has the ending of `path`. A device or pipe is written straight.

    Raises:
        OutputError: the folder or the file cannot be written, or the disk is full.
    """
    path = Path(path)
    if path.is_dir():
        raise OutputError(f'cannot write "{path}": it is a folder; name a file')
    if path.exists() and not path.is_file():
        with _explained(path, path):
            yield path
        return
    target = path.resolve()  # a link keeps pointing where it points
    beside = target.with_name(f".{target.stem}.{os.getpid()}.partial{target.suffix}")
    with _explained(path, beside):
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield beside
            beside.replace(target)
        finally:
            beside.unlink(missing_ok=True)


@contextmanager
def _explained(path: Path, beside: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        named = Path(os.fsdecode(error.filename)) if isinstance(error.filename, str | bytes) else None
        if named is not None and named not in (path, beside, *path.resolve().parents):
            raise  # something else that could not be read
        if error.errno == errno.ENOSPC:
            raise OutputError(f'cannot write "{path}": the disk is full; free some space or write elsewhere') from error
        reason = error.strerror or str(error).split("\n", 1)[0] or type(error).__name__
        raise OutputError(f'cannot write "{path}": {reason}; write elsewhere') from error
