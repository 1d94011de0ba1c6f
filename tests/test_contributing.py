"""CONTRIBUTING names every room of the package and of the diagnosis, every script, and only what is there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

NOT_ROOMS = {"__init__.py", "__init__.pyi", "__main__.py", "__pycache__", "py.typed"}


@pytest.fixture
def page(repository: Path) -> str:
    return (repository / "CONTRIBUTING.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("folder", ["exo_sim", "exo_sim/diagnosis"])
def test_a_newcomer_finds_every_room(repository: Path, page: str, folder: str) -> None:
    rooms = {f"{path.name}/" if path.is_dir() else path.name for path in (repository / folder).iterdir() if path.name not in NOT_ROOMS}
    assert {room for room in rooms if f"`{room}`" not in page} == set()


def test_a_newcomer_finds_every_script(repository: Path, page: str) -> None:
    scripts = {path for path in (repository / "scripts").iterdir() if path.name != "__pycache__"}
    assert {path.name for path in scripts if path.is_file() and f"`scripts/{path.name}" not in page} == set()
    assert {path.name for path in scripts if path.is_dir() and f"`{path.name}/`" not in page} == set()


def test_what_is_named_is_there(repository: Path, page: str) -> None:
    named = set(re.findall(r"`((?:exo_sim|tests|docs|scripts)/[\w./]+\w)`?", page))
    named -= {"exo_sim/cli/VERB.py"}
    assert {name for name in named if not (repository / name).exists()} == set()
