"""What a command took, how it ended, and that it is stopped when its time is up."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

from exo_sim.errors import TrialError
from exo_sim.trials.resource_use import used_by


def test_status_words_and_processor_time(tmp_path: Path) -> None:
    code = "import sys; sum(range(3_000_000)); print('said', file=sys.stderr); sys.exit(3)"
    status, words, used = used_by([sys.executable, "-c", code], tmp_path, os.environ, 60.0)
    assert (status, words) == (3, "said") and 0.0 < used.ru_utime < 60.0


def test_what_takes_longer_than_it_may_is_stopped(tmp_path: Path) -> None:
    assert used_by([sys.executable, "-c", "while True: pass"], tmp_path, os.environ, 1.0)[0] == -1


def test_what_cannot_be_started_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(TrialError, match="cannot run"):
        used_by([str(tmp_path / "none")], tmp_path, os.environ, 1.0)


def test_what_it_started_does_not_outlive_its_time(tmp_path: Path) -> None:
    code = "import subprocess, sys; subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])"
    used_by([sys.executable, "-c", code.replace("subprocess.Popen(", "p = subprocess.Popen(") + "; open('pid', 'w').write(str(p.pid))"],
            tmp_path, os.environ, 60.0)  # fmt: skip
    left = int((tmp_path / "pid").read_text())
    for _ in range(500):
        try:
            state = Path(f"/proc/{left}/stat").read_text().split()[2]
        except FileNotFoundError:
            return
        if state == "Z":
            return
        time.sleep(0.01)
    pytest.fail("it is still at work")


def test_words_that_are_no_text_are_told(tmp_path: Path) -> None:
    code = "import os; os.write(2, b'\\xff\\x1b[2J no text' + b'.' * 10**6)"
    status, words, _ = used_by([sys.executable, "-c", code], tmp_path, os.environ, 60.0)
    assert status == 0 and len(words) == 500
