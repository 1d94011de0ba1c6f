"""What ended a verb becomes one line on stderr and an exit status."""

from __future__ import annotations

import errno
from pathlib import Path

import click
import pytest
from numba.core.errors import TypingError

from exo_sim.cli import failures
from exo_sim.errors import Diverged, RigError
from exo_sim.physics import external_effects


def test_what_numba_cannot_compile_is_the_fault_of_an_effect_from_outside(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    error = TypingError("Failed in nopython mode pipeline (step: nopython frontend)\nUnknown attribute 'pp' of type Chamber")
    assert failures.report(error) == failures.OUR_FAULT
    (tmp_path / "mine.py").write_text("EFFECT = None")
    monkeypatch.setenv(external_effects.VARIABLE, str(tmp_path / "mine.py"))
    assert failures.report(error) == 2
    ours, yours = capsys.readouterr().err.splitlines()
    assert "a fault of exo-sim" in ours
    assert "mine.py): Unknown attribute 'pp' of type Chamber; write them with what numba knows" in yours


@pytest.mark.parametrize(
    ("error", "status", "says"),
    [
        (RigError("rig.toml: bore\nis missing"), 2, "exo-sim: rig.toml: bore is missing"),
        (Diverged("diverged at 1.2 s"), Diverged("").exit_status, "exo-sim: diverged at 1.2 s"),
        (OSError(errno.ENOSPC, "No space", "out.rrd"), 2, 'exo-sim: "out.rrd": the disk is full'),
        (FileNotFoundError(errno.ENOENT, "No such file", "a.csv"), 2, 'exo-sim: "a.csv": no such file or folder'),
        (MemoryError(), 2, "exo-sim: out of memory"),
        (KeyboardInterrupt("2 s are kept"), failures.INTERRUPTED, "exo-sim: interrupted; 2 s are kept"),
        (ZeroDivisionError("division by zero"), failures.OUR_FAULT, "exo-sim: ZeroDivisionError: division by zero (a fault of exo-sim"),
        (click.BadParameter("no such unit."), 2, "exo-sim: invalid value: no such unit"),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, BaseException) else None,
)  # fmt: skip
def test_each_kind_has_its_line_and_status(capsys: pytest.CaptureFixture[str], error: BaseException, status: int, says: str) -> None:
    assert failures.report(error, debug=False) == status
    err = capsys.readouterr().err
    assert err.startswith(says) and err.count("\n") == 1


def test_ctrl_c_is_the_cause_of_a_fault_that_follows_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert failures.report(ZeroDivisionError(), debug=False, interrupted=True) == failures.INTERRUPTED
    assert capsys.readouterr().err == "exo-sim: interrupted\n"
    assert failures.report(RigError("wrong"), debug=False, interrupted=True) == 2


def test_what_ended_by_itself_says_nothing_more(capsys: pytest.CaptureFixture[str]) -> None:
    assert failures.report(SystemExit(3), debug=False) == 3 and failures.report(SystemExit("words"), debug=False) == 1
    assert failures.report(BrokenPipeError(), debug=False) == failures.BROKEN_PIPE
    assert capsys.readouterr().err == ""
