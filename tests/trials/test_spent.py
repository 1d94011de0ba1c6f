"""What a command took, how it ended, and that it is stopped when its time is up."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from exo_sim.errors import TrialError
from exo_sim.trials.spent import used_by


def test_status_words_and_processor_time(tmp_path: Path) -> None:
    code = "import sys; sum(range(3_000_000)); print('said', file=sys.stderr); sys.exit(3)"
    status, words, used = used_by([sys.executable, "-c", code], tmp_path, os.environ, 60.0)
    assert (status, words) == (3, "said") and 0.0 < used.ru_utime < 60.0


def test_what_takes_longer_than_it_may_is_stopped(tmp_path: Path) -> None:
    assert used_by([sys.executable, "-c", "while True: pass"], tmp_path, os.environ, 1.0)[0] == -1


def test_what_cannot_be_started_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(TrialError, match="cannot run"):
        used_by([str(tmp_path / "none")], tmp_path, os.environ, 1.0)
