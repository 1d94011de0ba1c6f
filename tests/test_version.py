"""The version is one: what the package says, what is installed, and what is cited."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import exo_sim
from exo_sim.version import VERSION


def test_all_files_name_the_same_version(repository: Path) -> None:
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    cited = re.search(r"^version: (\S+)$", (repository / "CITATION.cff").read_text(), re.MULTILINE)
    assert cited is not None
    assert exo_sim.__version__ == VERSION == project["version"] == cited[1]
