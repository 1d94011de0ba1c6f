"""JSON that somebody else may have written: whatever it holds, it is read or refused in one sentence."""

from __future__ import annotations

import json
import stat
from pathlib import Path
from typing import Any

#: Bytes of a file beyond which it is refused.
MOST_BYTES = 200_000_000


def parsed(text: str | bytes) -> Any:
    """Return what JSON says.

    Raises:
        ValueError: it is no JSON, not UTF-8, nested too deeply, or has a number of thousands of digits.
    """
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def read_json(path: Path) -> Any:
    """Return what a JSON file says.

    Raises:
        FileNotFoundError: there is none.
        ValueError: it is no regular file, larger than `MOST_BYTES`, or as `parsed`.
    """
    held = path.stat()
    if not stat.S_ISREG(held.st_mode):
        raise ValueError("no regular file")
    if held.st_size > MOST_BYTES:
        raise ValueError(f"{held.st_size / 1e6:.0f} MB, more than {MOST_BYTES / 1e6:.0f}")
    return parsed(path.read_bytes())
