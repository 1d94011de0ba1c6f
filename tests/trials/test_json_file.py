"""JSON of others is read or refused in one sentence."""

from __future__ import annotations

from pathlib import Path

import pytest

from exo_sim.trials.json_file import read_json


def test_files(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text("[1]")
    assert read_json(tmp_path / "a.json") == [1]
    with pytest.raises(ValueError, match="no regular file"):
        read_json(tmp_path)
    with pytest.raises(FileNotFoundError):
        read_json(tmp_path / "b.json")
