"""What is kept between starts is what would be found again, and nothing else is ever met."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from exo_sim import kept_solutions
from exo_sim import rig as rigs
from exo_sim.gait import residual_reduction
from exo_sim.simulation.walk import Request, Walk, default_rig
from exo_sim.simulation.worn import Simulation


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("EXO_SIM_CACHE", str(tmp_path))
    monkeypatch.delenv("EXO_SIM_KEEP", raising=False)
    return kept_solutions.folder()


def finding(value: float, asked: list[float]) -> np.ndarray:
    asked.append(value)
    return np.array([[value, 1.0]])


def test_it_is_found_once_and_for_other_questions_anew(folder: Path) -> None:
    asked: list[float] = []
    for _ in range(2):
        np.testing.assert_array_equal(kept_solutions.kept(b"a", lambda: finding(1.0, asked)), [[1.0, 1.0]])
    np.testing.assert_array_equal(kept_solutions.kept(b"b", lambda: finding(2.0, asked)), [[2.0, 1.0]])
    assert asked == [1.0, 2.0]
    assert len(list(folder.iterdir())) == 2 and folder.stat().st_mode & 0o077 == 0


def test_a_file_that_is_broken_or_from_other_hands_is_not_read(folder: Path) -> None:
    asked: list[float] = []
    kept_solutions.kept(b"a", lambda: finding(1.0, asked))
    (only,) = folder.iterdir()
    only.write_bytes(only.read_bytes()[:60])
    kept_solutions.kept(b"a", lambda: finding(1.0, asked))
    np.testing.assert_array_equal(kept_solutions.kept(b"a", lambda: finding(9.0, asked)), [[1.0, 1.0]])
    assert asked == [1.0, 1.0]
    folder.chmod(0o777)
    kept_solutions.kept(b"a", lambda: finding(3.0, asked))
    assert asked[-1] == 3.0


def test_an_edit_of_the_program_is_never_met_by_what_was_found_before(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []
    kept_solutions.kept(b"a", lambda: finding(1.0, asked))
    monkeypatch.setattr(kept_solutions, "_program", lambda: b"other")
    kept_solutions.kept(b"a", lambda: finding(2.0, asked))
    assert asked == [1.0, 2.0]


def test_it_can_be_switched_off_and_does_without_a_folder(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []
    monkeypatch.setenv("EXO_SIM_KEEP", "0")
    kept_solutions.kept(b"a", lambda: finding(1.0, asked))
    assert not folder.exists()
    monkeypatch.delenv("EXO_SIM_KEEP")
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("EXO_SIM_CACHE", str(tmp_path / "file"))
    kept_solutions.kept(b"a", lambda: finding(2.0, asked))
    assert asked == [1.0, 2.0]


def test_the_oldest_go(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept_solutions, "_MOST", 2)
    asked: list[float] = []
    for number, name in enumerate((b"a", b"b", b"c")):
        kept_solutions.kept(name, lambda: finding(1.0, asked))
        for path in folder.glob("*.npy"):
            if path.stat().st_mtime > 1e6:
                os.utime(path, (number, number))
    kept_solutions.kept(b"c", lambda: finding(1.0, asked))
    assert len(asked) == 3
    kept_solutions.kept(b"a", lambda: finding(1.0, asked))
    assert len(asked) == 4


def walk() -> Walk:
    return Simulation(rigs.read(default_rig()), Request("level_walk", 34.0, cycles=3, rehearsals=3)).run()


def test_a_walk_with_what_was_kept_is_the_same_to_the_last_bit(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def forget() -> None:
        monkeypatch.setattr(residual_reduction, "_kept", {})

    forget()
    first = walk()
    count = len(list(folder.iterdir()))
    assert count == 2  # how he leans with the machine, and the torques
    forget()
    again = walk()
    assert len(list(folder.iterdir())) == count
    forget()
    monkeypatch.setenv("EXO_SIM_KEEP", "0")
    anew = walk()
    for other in (again, anew):
        assert first.columns.keys() == other.columns.keys()
        for key, values in first.columns.items():
            np.testing.assert_array_equal(values, other.columns[key])
