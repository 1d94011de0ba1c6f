"""Everything that can be wrong with what people hand to the tool.

One tree. A message is one line: the file, the key or column, the value, and what to do about it.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from pathlib import Path

#: The longest line that an error becomes, in characters.
LONGEST_LINE = 1000
#: Longer names are not searched for a nearest one, nor among more than so many: that takes the product of all lengths.
_LONGEST_NAME, _MOST_NAMES = 100, 2000
#: A further name is suggested beside the nearest one where its similarity, 0 to 1, is less by no more than this.
_ALSO_LIKELY = 0.15
_UNPRINTABLE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


class ExoSimError(Exception):
    """Something a user can put right. `exit_status` is what the command ends with."""

    exit_status = 2


class UnitError(ExoSimError):
    """A quantity whose unit is missing, unknown, of the wrong kind, or gauge where absolute is meant."""


class RigError(ExoSimError):
    """A rig file that cannot be read, or a machine that cannot be."""


class ModelError(ExoSimError):
    """An MJCF that MuJoCo refuses, or that lacks a part the rig names."""


class RecordingError(ExoSimError):
    """A recording that cannot be read or used."""


class ScenarioError(ExoSimError):
    """A scenario, payload, cadence or control setting that does not exist or cannot be carried out."""


class OutputError(ExoSimError):
    """A result that cannot be written."""


class TrialError(ExoSimError):
    """A trial folder that is incomplete, opened early, or altered."""


class Diverged(ExoSimError):
    """The simulation left the range of numbers that mean anything."""

    exit_status = 5


def near(name: str, choices: Iterable[str]) -> list[str]:
    """Return the names that a misspelt one is likely to mean, the likeliest first, three at most; [] where none is near."""
    few = [choice for choice in sorted(choices) if len(choice) <= _LONGEST_NAME][:_MOST_NAMES]
    close = difflib.get_close_matches(name, few, n=3, cutoff=0.6) if len(name) <= _LONGEST_NAME else []
    likeness = [difflib.SequenceMatcher(None, match, name).ratio() for match in close]
    return [match for match, alike in zip(close, likeness) if alike > likeness[0] - _ALSO_LIKELY]


def nearest(name: str, choices: Iterable[str]) -> str:
    """Return `; did you mean "a" or "b"?` for a misspelt name, else `; there is: a, b, c`, or "" with no choices."""
    known = sorted(choices)
    if close := near(name, known):
        return _asked(close)
    return "; there is: " + ", ".join(known) if known else ""


def misspelt(path: Path) -> str:
    """Return `; did you mean "bench.csv"?` for a file that is not there where its folder has one of nearly that name, else ""."""
    try:
        found = near(path.name, [entry.name for entry in path.parent.iterdir()])
    except OSError:
        found = []
    return _asked(found)


def _asked(names: list[str]) -> str:
    return "; did you mean " + " or ".join(f'"{name}"' for name in names) + "?" if names else ""


def printable(text: str) -> str:
    """Return text as a terminal may have it: what steers one, turns the direction of writing or is no character becomes an escape.

    Every escape is one that JSON has too.
    """
    return _UNPRINTABLE.sub(lambda found: f"\\u{ord(found.group()):04x}", text)


def one_line(text: str, most: int = LONGEST_LINE) -> str:
    """Return text as one printable line of at most `most` characters; of a longer one begin and end stay."""
    line = printable(" ".join(text.split()))
    if len(line) <= most:
        return line
    head = (3 * most) // 4
    return f"{line[:head]} ... {line[len(line) - (most - head - 5):]}"
