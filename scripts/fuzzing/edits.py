"""What can be done to a file so that it is no longer what was meant: each edit is a plain list, so that a case is one line of JSON.

Places are counted round: the hundredth value of a file with thirty is its tenth. So a case still breaks something after a base changed.
"""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

#: Bytes that a file is not grown beyond.
MOST_BYTES = 4_000_000
_VALUE = re.compile(rb"(?m)^(\s*\S+\s*=[ \t]*)([^\n#]*)")
_KEY = re.compile(rb"(?m)^(\s*)([^\s=\[#]+)(?=\s*=)")
_TABLE = re.compile(rb"(?m)^(\[)([^\]\n]*)(?=\])")
_ATTRIBUTE = re.compile(rb'(\w+=")([^"]*)(?=")')
_ELEMENT = re.compile(rb"()(<\w[^<>]*/>)")


def apply(folder: Path, edit: list[Any]) -> None:
    """Do one edit to a folder; one whose file is not there any more does nothing."""
    kind, name, *rest = edit
    path = folder / name
    if kind == "kind":
        _other_kind(path, rest[0])
    elif kind == "add":
        path.write_bytes(raw(rest[0]))
    elif path.is_file() and not path.is_symlink():
        path.write_bytes(_EDITS[kind](path.read_bytes(), *rest)[:MOST_BYTES])


def raw(text: str) -> bytes:
    """Return the bytes that a text of a case stands for: its characters where all are below 256, else UTF-8."""
    try:
        return text.encode("latin-1")
    except UnicodeEncodeError:
        return text.encode("utf-8", "surrogatepass")


def _other_kind(path: Path, kind: str) -> None:
    """Put something else in a file's place."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    path.unlink(missing_ok=True)
    if kind == "folder":
        path.mkdir()
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "loop":
        path.symlink_to(path.name)
    elif kind != "missing":
        path.symlink_to(kind)  # "/dev/zero"


def _splice(content: bytes, at: int, delete: int, insert: str) -> bytes:
    at %= len(content) + 1
    return content[:at] + raw(insert) + content[at + delete :]


def _repeat(content: bytes, at: int, length: int, times: int) -> bytes:
    at %= len(content) + 1
    piece = content[at : at + length]
    return content[:at] + piece * min(times, MOST_BYTES // max(len(piece), 1)) + content[at + length :]


def _cut(content: bytes, at: int) -> bytes:
    return content[: at % (len(content) + 1)]


def _nth(pattern: re.Pattern[bytes]) -> Callable[[bytes, int, str], bytes]:
    """Return an edit that puts a text in the place of the n-th match's second group."""

    def replace(content: bytes, n: int, text: str) -> bytes:
        found = list(pattern.finditer(content))
        if not found:
            return content
        match = found[n % len(found)]
        return content[: match.start(2)] + raw(text) + content[match.end(2) :]

    return replace


def _mark(content: bytes) -> bytes:
    """Return what stands between the cells of a table."""
    head = content.split(b"\n", 1)[0]
    return b";" if b";" in head else b"," if b"," in head else b"\t" if b"\t" in content else b","


def _line(content: bytes, n: int, text: str) -> bytes:
    lines = content.split(b"\n")
    lines[n % len(lines)] = raw(text)
    return b"\n".join(lines)


def _cell(content: bytes, row: int, column: int, text: str) -> bytes:
    lines = content.split(b"\n")
    row %= len(lines)
    mark = _mark(content)
    cells = lines[row].split(mark)
    cells[column % len(cells)] = raw(text)
    lines[row] = mark.join(cells)
    return b"\n".join(lines)


def _column(content: bytes, column: int, law: str, number: float) -> bytes:
    """Do something to every number of a column: what a sensor, a clock or a spreadsheet does."""
    head, *lines = content.split(b"\n")
    mark = _mark(content)
    column %= max(len(line.split(mark)) for line in (head, *lines[:20]))
    done: list[bytes] = []
    before = 0.0
    for i, line in enumerate(lines):
        cells = line.split(mark)
        if len(cells) <= column:
            done.append(line)
            continue
        try:
            value = float(cells[column])
        except ValueError:
            value = 0.0
        new = {
            "scale": value * number, "offset": value + number, "constant": number, "hold": value if i % 7 == 0 else before,
            "alternate": number if i % 2 else -number, "wrap": value % number if number else value, "nan": float("nan"),
        }[law]  # fmt: skip
        before = new
        cells[column] = b"%.12g" % new
        done.append(mark.join(cells))
    return b"\n".join([head, *done])


def _rows(content: bytes, start: int, length: int, law: str) -> bytes:
    head, *lines = content.split(b"\n")
    start %= len(lines) + 1
    piece = lines[start : start + length]
    new = {
        "drop": [],
        "twice": piece * 2,
        "backwards": piece[::-1],
        "blank": [b""] * len(piece),
        "short": [p[: len(p) // 2] for p in piece],
    }
    return b"\n".join([head, *lines[:start], *new[law], *lines[start + length :]])


def _leaf(content: bytes, n: int, value: Any) -> bytes:
    """Put a value in the place of the n-th value of JSON, or of JSON's lines."""
    try:
        lines = [json.loads(content)]
    except ValueError:
        try:
            lines = [json.loads(line) for line in content.splitlines()]
        except ValueError:
            return content
    places: list[tuple[Any, Any]] = []

    def walk(held: Any) -> None:
        for key, entry in list(held.items()) if isinstance(held, dict) else list(enumerate(held)) if isinstance(held, list) else []:
            places.append((held, key))
            walk(entry)

    walk(lines)
    if places:
        held, key = places[n % len(places)]
        held[key] = value
    return "".join(json.dumps(line) + "\n" for line in lines).encode()


_EDITS: dict[str, Callable[..., bytes]] = {
    "splice": _splice,
    "repeat": _repeat,
    "cut": _cut,
    "value": _nth(_VALUE),
    "key": _nth(_KEY),
    "table": _nth(_TABLE),
    "attribute": _nth(_ATTRIBUTE),
    "element": _nth(_ELEMENT),
    "line": _line,
    "cell": _cell,
    "column": _column,
    "rows": _rows,
    "leaf": _leaf,
}
