"""The machines that come with the package, by name."""

from __future__ import annotations

import os
from pathlib import Path

_FOLDER = Path(__file__).resolve().parents[1] / "assets"


def included_machines() -> dict[str, Path]:
    """Return the rig files that come with the package, by the name of their machine."""
    return {path.stem: path for path in sorted(_FOLDER.glob("*.toml"))}


def rig_file(rig: str | os.PathLike[str]) -> Path:
    """Return the path of a rig: the file, or where there is no such file that of the included machine of this name."""
    path = Path(rig)
    return path if path.exists() else included_machines().get(str(rig), path)
