"""A machine that comes along goes by its name, unless a file has it."""

from __future__ import annotations

from pathlib import Path

import pytest

from exo_sim.rig import read
from exo_sim.rig.included_machines import included_machines, rig_file


def test_every_included_machine_is_a_rig_of_its_name() -> None:
    assert set(included_machines()) == {"bench", "exo", "exo_250_psi"}
    for path in included_machines().values():
        read(path)


def test_a_file_goes_before_an_included_machine_of_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert rig_file("exo") == included_machines()["exo"] and rig_file("exos") == Path("exos") and rig_file("a/exo") == Path("a/exo")
    Path("exo").write_text("")
    assert rig_file("exo") == Path("exo")
