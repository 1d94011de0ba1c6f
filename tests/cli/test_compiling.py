"""What a terminal shows while the first run compiles."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from numba.core import config

import exo_sim.physics.compiled  # noqa: F401 - it sets the folder, before the test does
from exo_sim.cli import compiling


@pytest.mark.parametrize(
    ("terminal", "kept", "quiet", "said"),
    [(True, False, False, True), (True, True, False, False), (True, False, True, False), (False, False, False, False)],
)
def test_the_first_run_says_on_a_terminal_that_it_compiles(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], terminal: bool, kept: bool, quiet: bool, said: bool
) -> None:
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal)
    if kept:
        (tmp_path / "simulation_1").mkdir()
        (tmp_path / "simulation_1" / "coupled_step.advance_gas-58.py311.nbi").touch()
    with compiling.announced(quiet) as aside:
        aside(lambda: print("a remark", file=sys.stderr))
    err = capsys.readouterr().err
    assert ("compiling, once, about a minute" in err) is said
    assert "\x1b[2Ka remark\n" in err if said else err == "a remark\n"


def test_where_no_machine_code_is_kept_it_is_compiled_every_time(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(config, "CACHE_DIR", "")
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with compiling.announced(False):
        pass
    assert "compiling, about a minute" in capsys.readouterr().err
