"""JSON of others is read or refused in one sentence."""

from __future__ import annotations

from pathlib import Path

import pytest

from exo_sim.trials.json_file import parsed, read_json


def test_what_json_says() -> None:
    assert parsed('{"a": [1, null]}') == {"a": [1, None]}


@pytest.mark.parametrize("text", ["{", b"\xff\xfe", "[" * 100_000, "1" * 5000])
def test_what_is_none_is_a_value_error(text: str | bytes) -> None:
    with pytest.raises(ValueError):
        parsed(text)


def test_files(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text("[1]")
    assert read_json(tmp_path / "a.json") == [1]
    with pytest.raises(ValueError, match="no regular file"):
        read_json(tmp_path)
    with pytest.raises(FileNotFoundError):
        read_json(tmp_path / "b.json")
