"""Where machine code is kept between starts: folders that this tool made, marked, and nobody else may write."""

from __future__ import annotations

import contextlib
import os
import re
import stat
import warnings
from pathlib import Path

#: A folder with this file in it was made here and may go again.
MARK = "made-by-exo-sim"
_KEPT = 4
_OURS = re.compile(r"[0-9a-f]{16}")
_CODE = (".nbi", ".nbc")


def root() -> Path:
    """Return the folder that holds the machine code of all versions."""
    cache = os.environ.get("EXO_SIM_CACHE") or os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(cache).expanduser() / "exo-sim" / "machine-code"


def folder(key: str) -> Path | None:
    """Return the folder of one version's machine code, made where it is missing, and drop the oldest others.

    None where it cannot be written, or where somebody else could put code there that would then be run: all is compiled anew
    at each start.
    """
    place = root() / key
    try:
        for made in (place.parent.parent, place.parent, place):
            made.mkdir(mode=0o700, parents=True, exist_ok=True)
        if (open_to := _open_to_others(place)) is not None:
            warnings.warn(
                f'"{open_to}" can be written by others: no machine code is taken from there, which makes starts slow; '
                f'close it to them (chmod go-w), or name another folder with EXO_SIM_CACHE',
                stacklevel=1,
            )
            return None
        (place / MARK).touch()
        os.utime(place)
        _drop_old(place.parent)
    except OSError:
        return None
    return place


def _open_to_others(place: Path) -> Path | None:
    """Return the first folder on the way to `place` that another user could change, or None."""
    if not hasattr(os, "geteuid"):
        return None  # Windows: the profile is the user's own
    ours = (place, place.parent, place.parent.parent)
    for each in (*ours, *ours[-1].resolve().parents):
        held = each.stat()
        if each in ours and (held.st_uid != os.geteuid() or held.st_mode & (stat.S_IWGRP | stat.S_IWOTH)):
            return each
        if held.st_mode & stat.S_IWOTH and not held.st_mode & stat.S_ISVTX:
            return each
    return None


def _drop_old(above: Path) -> None:
    """Take away all but the newest of the folders that were made here, and of these nothing but machine code."""
    made = [each for each in above.iterdir() if _OURS.fullmatch(each.name) and not each.is_symlink() and (each / MARK).is_file()]
    for old in sorted(made, key=lambda each: each.stat().st_mtime)[:-_KEPT]:
        with contextlib.suppress(OSError):
            for path in old.rglob("*"):
                if path.suffix in _CODE and not path.is_symlink():
                    path.unlink()
            for below in sorted((path for path in old.rglob("*") if path.is_dir()), reverse=True):
                below.rmdir()
            (old / MARK).unlink()
            old.rmdir()
