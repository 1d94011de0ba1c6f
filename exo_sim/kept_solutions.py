"""What takes long to find, kept between starts: how a wearer leans, torques that were rehearsed.

A file is named after a digest of all that its numbers follow from: what was asked, the text of the package, the versions that compute, and
the machine that does. So an edit is never met by what was found before it, and what is read is what would be found again. Numbers alone are
read. Where no folder can be written, or `EXO_SIM_KEEP` is 0, all is found anew at each start.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
import stat
from collections.abc import Callable
from functools import cache
from importlib.metadata import version
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: How many files stay: those that were read last. The largest, of a walk from rest to rest, has 100 kB.
_MOST = 200
_PACKAGE = Path(__file__).resolve().parent
_COMPUTING = ("mujoco", "numba", "numpy", "scipy")


def kept(asked: bytes, find: Callable[[], Array]) -> Array:
    """Return what `find` finds, or what it found at an earlier start where the same was asked.

    Args:
        asked: All that the numbers follow from beside the program.
        find: Finds them.
    """
    place = _place(asked)
    if place is None:
        return find()
    with contextlib.suppress(OSError, ValueError, EOFError):
        found = np.load(place, allow_pickle=False)
        os.utime(place)
        return np.asarray(found, dtype=np.float64)
    found = find()
    with contextlib.suppress(OSError):
        _save(place, found)
    return found


def folder() -> Path:
    """Return the folder that holds them."""
    above = os.environ.get("EXO_SIM_CACHE") or os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(above).expanduser() / "exo-sim" / "solutions"


def _place(asked: bytes) -> Path | None:
    """Return the file for what was asked, or None where nothing may be kept."""
    if os.environ.get("EXO_SIM_KEEP") == "0":
        return None
    place = folder()
    try:
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        held = place.stat()
    except OSError:
        return None
    if hasattr(os, "geteuid") and (held.st_uid != os.geteuid() or held.st_mode & (stat.S_IWGRP | stat.S_IWOTH)):
        return None  # somebody else could put other numbers there
    return place / f"{hashlib.sha256(_program() + asked).hexdigest()[:32]}.npy"


@cache
def _program() -> bytes:
    """Return a digest of the package's text, of the versions that compute with it, and of the machine."""
    digest = hashlib.sha256()
    for part in (platform.python_version(), platform.machine(), platform.node(), *(version(name) for name in _COMPUTING)):
        digest.update(f"{part}\0".encode())
    for path in sorted(_PACKAGE.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.digest()


def _save(place: Path, found: Array) -> None:
    beside = place.with_name(f"{place.stem}.{os.getpid()}.partial")
    with beside.open("wb") as file:
        np.save(file, found)
    beside.replace(place)
    files = sorted(place.parent.glob("*.npy"), key=lambda each: each.stat().st_mtime)
    for old in files[:-_MOST]:
        old.unlink()
