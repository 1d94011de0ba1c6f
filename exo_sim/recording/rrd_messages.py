"""An .rrd that was being written when its process was killed: its last message may be torn, all before it are whole."""

from __future__ import annotations

import os
import re
import shutil
import struct
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_HEADER = 12
_MESSAGE = struct.Struct("<QQ")  # kind and length of what follows, as rerun's encoder writes them
_UNFINISHED = re.compile(r".+\.unfinished-\d+\.rrd")


def unfinished(path: Path) -> Path:
    """Return the name under which a recording of this process grows until it is whole."""
    return path.with_name(f"{path.stem[:200]}.unfinished-{os.getpid()}{path.suffix}")


def is_unfinished(path: Path) -> bool:
    """Return whether a file has the name of one that grows, or grew until its process was killed."""
    return _UNFINISHED.fullmatch(path.name) is not None


@contextmanager
def whole_messages(path: Path) -> Iterator[Path]:
    """Give a file with what is whole of an .rrd: itself, or a passing copy of one that was left unfinished with a torn message."""
    if not is_unfinished(path) or (length := _whole_length(path)) == path.stat().st_size:
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="exo-sim-") as folder:
        copy = Path(folder) / path.name
        shutil.copyfile(path, copy)
        os.truncate(copy, length)
        yield copy


def _whole_length(path: Path) -> int:
    """Return how many bytes of an .rrd are whole messages."""
    size, end = path.stat().st_size, _HEADER
    with path.open("rb") as file:
        while end + _MESSAGE.size <= size:
            file.seek(end)
            _, length = _MESSAGE.unpack(file.read(_MESSAGE.size))
            if end + _MESSAGE.size + length > size:
                break
            end += _MESSAGE.size + length
    return min(end, size)
