"""What the faults rely on: a child is ended as it should be, and what is not whole or left behind is noticed."""

from __future__ import annotations

import shutil
import signal
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest


@pytest.fixture(autouse=True)
def scripts(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(repository / "scripts"))


def walk():
    from fault_kinds.commands import COMMANDS

    return next(command for command in COMMANDS if command.name == "run")


def test_what_is_half_written_or_left_behind_is_noticed(tmp_path):
    from fault_kinds.commands import half_written, left_behind

    from exo_sim.recording import Recording
    from exo_sim.recording.table_file import write_table

    table = tmp_path / "walk.parquet"
    write_table(table, Recording("a", np.arange(50.0), {"slide.position": np.arange(50.0)}, {"slide.position": "m"}))
    assert half_written(walk(), tmp_path) == []
    table.write_bytes(table.read_bytes()[:-20])
    (found,) = half_written(walk(), tmp_path)
    assert found.startswith("run: walk.parquet is not whole")
    (tmp_path / ".walk.12@host.partial.rrd").write_text("")
    (tmp_path / "walk.unfinished-12.rrd").write_text("")
    assert left_behind(walk(), tmp_path, set()) == [".walk.12@host.partial.rrd"]


@pytest.mark.slow
def test_a_child_ends_by_itself_or_as_it_is_told(tmp_path, repository):
    from fault_kinds.child import run

    for name in ("exo.toml", "exo.xml"):
        shutil.copyfile(repository / "assets" / name, tmp_path / name)
    assert run(("scenarios",), tmp_path, tmp_path / "said").status == 0
    assert run(("scenaros",), tmp_path, tmp_path / "said").err.startswith("exo-sim: no verb")
    words = replace(walk(), words=("run", "level_walk", "--rig", "exo.toml", "--strides", "9000", "-q")).words
    assert run(words, tmp_path, tmp_path / "said", 1.0, signal.SIGKILL).status == -signal.SIGKILL
