"""JSON that somebody else may have written: whatever it holds, it is read or refused in one sentence."""

from __future__ import annotations

import stat
from pathlib import Path
from typing import Any

from exo_sim.inputs import json_value

#: Bytes of a file beyond which it is refused.
MOST_BYTES = 200_000_000


def read_json(path: Path) -> Any:
    """Return what a JSON file says.

    Raises:
        FileNotFoundError: there is none.
        ValueError: it is no regular file, larger than `MOST_BYTES`, or as `json_value`.
    """
    held = path.stat()
    if not stat.S_ISREG(held.st_mode):
        raise ValueError("no regular file")
    if held.st_size > MOST_BYTES:
        raise ValueError(f"{held.st_size / 1e6:.0f} MB, more than {MOST_BYTES / 1e6:.0f}")
    return json_value(path.read_bytes())
