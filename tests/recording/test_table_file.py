"""A file that is not what its ending says is refused in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from exo_sim.errors import RecordingError
from exo_sim.recording import read


@pytest.mark.parametrize("ending", [".mat", ".mcap", ".sto", ".mot", ".parquet"])
@pytest.mark.parametrize("content", [
    b"x", b"MATLAB 5.0 MAT-file" + bytes(500), b"\x89HDF\r\n\x1a\n" + bytes(100), b"\x89MCAP0\r\n" + bytes(99),
])  # fmt: skip
def test_what_is_no_such_file_is_one_line(tmp_path: Path, ending: str, content: bytes) -> None:
    path = tmp_path / f"broken{ending}"
    path.write_bytes(content)
    with pytest.raises(RecordingError) as caught:
        read(path)
    assert "\n" not in str(caught.value) and "broken" in str(caught.value)
