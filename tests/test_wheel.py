"""What a wheel must hold: the machines, scenarios and pages that the package opens by path, and nothing of the checkout around it."""

from __future__ import annotations

import tomllib
from pathlib import Path

from exo_sim import rig
from exo_sim.machine.rig_model import load
from exo_sim.simulation.walk import default_rig


def test_the_machine_that_comes_along_lies_inside_the_package(repository: Path) -> None:
    assert default_rig().is_relative_to(repository / "exo_sim")
    load(rig.read(default_rig()))


def test_every_data_file_has_an_ending_that_is_packed(repository: Path) -> None:
    """setuptools packs what the patterns of package-data name; a file of another kind would be missing in the wheel alone."""
    table = tomllib.loads((repository / "pyproject.toml").read_text())
    packed = {Path(pattern).suffix or pattern for pattern in table["tool"]["setuptools"]["package-data"]["exo_sim"]}
    for path in (repository / "exo_sim").rglob("*"):
        if path.is_file() and "__pycache__" not in path.parts and path.suffix not in (".py", ".pyc"):
            assert path.suffix in packed or path.name in packed, path
