"""What verbs print: data to stdout, words to stderr."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from exo_sim.cli import streams
from exo_sim.errors import printable


def json_text(data: Any) -> str:
    """Return JSON of plain values, paths, NumPy numbers and arrays; NaN and infinities become null."""
    return printable(json.dumps(_plain(data), indent=1, ensure_ascii=False, allow_nan=False))


def show(data: dict[str, Any], text: str, *, as_json: bool, out: Path | None = None) -> None:
    """Print a result once: as one JSON object or as text for people, to stdout or into the file `out`.

    Raises:
        OutputError: `out` cannot be written.
    """
    shown = json_text(data) if as_json else printable(text.rstrip("\n"))
    if out is None:
        print(shown if streams.holds_unicode(sys.stdout) else _in_ascii(shown))
        return
    from exo_sim.outputs import replacing

    with replacing(out) as beside:
        beside.write_text(shown + "\n", encoding="utf-8")


def remark(text: str, *, quiet: bool = False) -> None:
    """Say something to a person, on stderr."""
    if not quiet:
        streams.say(text)


def table(rows: Sequence[Sequence[object]], header: Sequence[str] = ()) -> str:
    """Return rows as aligned columns; numbers to the right, words to the left."""
    cells = [[str(cell) for cell in row] for row in ([header, *rows] if header else rows)]
    if not cells:
        return ""
    widths = [max(len(row[i]) for row in cells) for i in range(len(cells[0]))]
    fill = [str.rjust if rows and all(_numeric(str(row[i])) for row in rows) else str.ljust for i in range(len(widths))]
    lines = ["  ".join(put(cell, width) for put, cell, width in zip(fill, row, widths)) for row in cells]
    return "\n".join(line.rstrip() for line in lines)


def _in_ascii(text: str) -> str:
    """Return text with escapes, which JSON reads back, for every other character than ASCII's."""
    return "".join(each if each.isascii() else json.dumps(each)[1:-1] for each in text)


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
