"""How a case is handed to a tool: copies in a folder of their own, one command, one thread."""

from __future__ import annotations

import os
import re
import shlex
import shutil
from collections.abc import Collection
from pathlib import Path


def lay_out(case: Path, files: Collection[str], bare: Path) -> list[str]:
    """Copy a case's files into a bare folder; return the names of its recordings."""
    for file in files:
        shutil.copy(case / file, bare)
    return sorted(file for file in files if file.startswith("recording"))


def bring_back(answer: Path, out: Path, case: Path) -> None:
    """Copy what a tool wrote; the improved rig finds its MJCF beside the case, no longer in the bare folder."""
    shutil.copy(answer / "diagnosis.json", out)
    improved = answer / "improved.toml"
    if improved.exists():
        there = Path(os.path.relpath(case, out)).as_posix()
        text = re.sub(r'^(model\s*=\s*")\.\./', rf"\g<1>{there}/", improved.read_text(encoding="utf-8"), flags=re.MULTILINE)
        (out / improved.name).write_text(text, encoding="utf-8")


def command(tool: str, recordings: Collection[str]) -> list[str]:
    """Return the command line that diagnoses what lies in the folder it is started in; its answer goes to `out`."""
    return [*shlex.split(tool), *recordings, "--rig", "rig.toml", "--out", "out"]


def environment() -> dict[str, str]:
    """Return the environment of a tool: cases share the cores, so each takes one thread."""
    return {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
