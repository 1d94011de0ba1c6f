"""Ctrl-C while the program is loaded, or while the interpreter shuts down behind it: no traceback, and no other end than an interrupt's."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="a process cannot send itself Ctrl-C there")
INTERRUPT = "import os, signal; os.kill(os.getpid(), signal.SIGINT)\n"
#: The handler that a process in the foreground begins with; a shell that starts the tests behind itself has interrupts ignored.
FOREGROUND = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"


def ended(folder: Path, *words: str, first: str = "") -> subprocess.CompletedProcess[str]:
    """Run the command with modules of this folder before all others, after these lines of Python."""
    (folder / "sitecustomize.py").write_text(FOREGROUND + first)
    path = os.pathsep.join([str(folder), str(Path(__file__).resolve().parents[1])])
    return subprocess.run([sys.executable, "-m", "exo_sim", *words], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path})


def test_while_it_is_loaded(tmp_path: Path) -> None:
    (tmp_path / "click.py").write_text(INTERRUPT)  # what the command imports before any handler of its own stands
    found = ended(tmp_path, "--version")
    assert (found.returncode, found.stdout, found.stderr) == (-signal.SIGINT, "", "")


def test_while_the_interpreter_shuts_down(tmp_path: Path) -> None:
    found = ended(tmp_path, "scenarios", first="import atexit, os; atexit.register(lambda: os.kill(os.getpid(), signal.SIGINT))\n")
    assert found.returncode == -signal.SIGINT and "level_walk" in found.stdout and found.stderr == ""


def test_who_ignores_interrupts_goes_on(tmp_path: Path) -> None:
    found = ended(tmp_path, "scenarios", first="signal.signal(signal.SIGINT, signal.SIG_IGN)\n" + INTERRUPT)
    assert found.returncode == 0 and found.stderr == ""
