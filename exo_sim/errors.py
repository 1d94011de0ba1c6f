"""Everything that can be wrong with what people hand to the tool.

One tree. A message is one line: the file, the key or column, the value, and what to do about it.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable


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


def nearest(name: str, choices: Iterable[str]) -> str:
    """Return `; did you mean "a" or "b"?` for a misspelt name, else `; there is: a, b, c`, or "" with no choices."""
    known = sorted(choices)
    close = difflib.get_close_matches(name, known, n=3, cutoff=0.6)
    if close:
        return "; did you mean " + " or ".join(f'"{match}"' for match in close) + "?"
    return "; there is: " + ", ".join(known) if known else ""
