"""What was asked of a recording before any physics, and what was put right on the way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Check:
    """One question to whoever recorded.

    Attributes:
        what: One word or two for machines: "gauge", "unit", "swapped chambers", "turned valve", "stroke", "sign", "acting", "command",
            "late command", "part", "column", "unread", "valve", "valve kind".
        columns: Which columns it is about.
        says: The question, and what was done or must be done, in one plain sentence.
        refused: True where nothing sensible can be computed until it is answered.
        value: By how much it is off, in SI, where that is known; 0 elsewhere.
        left: True where nothing was done: the column is used as it is.
        meant: The column that it was evidently meant to be, where nothing reads it under its name; else "".
    """

    what: str
    columns: tuple[str, ...]
    says: str
    refused: bool = False
    left: bool = False
    meant: str = ""
    value: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """Return what `diagnosis.json` lists under `checks`."""
        return {"what": self.what, "columns": list(self.columns), "says": self.says} | ({"meant": self.meant} if self.meant else {})


def named(columns: tuple[str, ...]) -> str:
    """Return columns as they are named in a sentence."""
    *others, last = (f'"{column}"' for column in columns)
    return f"{', '.join(others)} and {last}" if others else last
