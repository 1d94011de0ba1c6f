"""One thing that is tried: a base, what is done to its files, and the command."""

from __future__ import annotations

import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fuzzing import edits


@dataclass(frozen=True)
class Case:
    """What is tried.

    Attributes:
        base: Name of the folder that it begins with.
        words: What stands behind `exo-sim`; `machine RIG` instead drives the rig's machine and closes its books.
        edits: What is done to the folder before, see `fuzzing.edits`.
    """

    base: str
    words: tuple[str, ...]
    edits: tuple[list[Any], ...] = ()

    def lay_out(self, bases: Path, folder: Path) -> None:
        """Make the folder in which the command is run."""
        shutil.copytree(bases / self.base, folder)
        for edit in self.edits:
            edits.apply(folder, edit)

    def line(self) -> str:
        """Return the case as one line of JSON."""
        return json.dumps({"base": self.base, "words": self.words, "edits": self.edits})

    @classmethod
    def read(cls, line: str) -> Case:
        """Return what `line` wrote."""
        held = json.loads(line)
        return cls(held["base"], tuple(held["words"]), tuple(held["edits"]))
