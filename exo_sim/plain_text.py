"""Results as text: JSON of plain values, and tables with aligned columns."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from exo_sim.errors import printable


def json_text(data: Any) -> str:
    """Return JSON of plain values, paths, NumPy numbers and arrays; NaN and infinities become null."""
    return printable(json.dumps(_plain(data), indent=1, ensure_ascii=False, allow_nan=False))


def table(rows: Sequence[Sequence[object]], header: Sequence[str] = ()) -> str:
    """Return rows as aligned columns; numbers to the right, words to the left."""
    cells = [[str(cell) for cell in row] for row in ([header, *rows] if header else rows)]
    if not cells:
        return ""
    widths = [max(len(row[i]) for row in cells) for i in range(len(cells[0]))]
    fill = [str.rjust if rows and all(_numeric(str(row[i])) for row in rows) else str.ljust for i in range(len(widths))]
    lines = ["  ".join(put(cell, width) for put, cell, width in zip(fill, row, widths)) for row in cells]
    return "\n".join(line.rstrip() for line in lines)


def _numeric(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, Path):
        return str(value)
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
