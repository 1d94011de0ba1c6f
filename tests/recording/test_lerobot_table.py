"""Episodes of LeRobot data sets give the table that went into them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from recording.one_table import TABLE, TIME, N, foreign, is_the_table

from exo_sim.errors import RecordingError
from exo_sim.recording import read


@pytest.mark.parametrize("names", [["P1", "q"], {"motors": ["P1", "q"]}])
def test_a_lerobot_episode(tmp_path: Path, names: Any) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    path = tmp_path / "data" / "chunk-000" / "episode_000001.parquet"
    path.parent.mkdir(parents=True)
    (tmp_path / "meta").mkdir()
    info = {"features": {"observation.state": {"dtype": "float64", "shape": [2], "names": names}, "timestamp": {"names": None}}}
    (tmp_path / "meta" / "info.json").write_text(json.dumps(info))
    frames = {"timestamp": TIME, "frame_index": np.arange(N), "episode_index": np.full(N, 1), "task_index": np.zeros(N, int),
              "observation.state": pa.FixedSizeListArray.from_arrays(TABLE[:, 1:].ravel(), 2)}  # fmt: skip
    parquet.write_table(pa.table(frames), path)
    columns = {"observation.state[P1]": "piston.pressure_1 [bar]", "observation.state[q]": "knee.position [deg]"}
    is_the_table(read(path, foreign(columns)).recording)
    several = pa.concat_tables([pa.table(frames), pa.table({**frames, "episode_index": np.full(N, 2)})])
    parquet.write_table(several, path)
    with pytest.raises(RecordingError, match="2 episodes, 1 to 2"):
        read(path, foreign(columns))
    is_the_table(read(path, foreign(columns, episode=2)).recording)
    (tmp_path / "meta" / "info.json").write_text("[]")
    with pytest.raises(RecordingError, match=r"info\.json"):
        read(path, foreign(columns, episode=2))


def _episode(folder: Path, index: Any, info: bytes) -> Path:
    import pyarrow as pa
    from pyarrow import parquet

    (folder / "meta").mkdir()
    (folder / "meta" / "info.json").write_bytes(info)
    state = pa.FixedSizeListArray.from_arrays(TABLE[:, 1:].ravel(), 2)
    frames = {"timestamp": TIME, "frame_index": np.arange(N), "episode_index": index, "observation.state": state}
    parquet.write_table(pa.table(frames), folder / "episode.parquet")
    return folder / "episode.parquet"


@pytest.mark.parametrize("index", [[None] * N, ["a"] * N, [1.5] * N, [0] * (N - 1) + [None]])
def test_an_episode_without_a_number_is_refused(tmp_path: Path, index: list[Any]) -> None:
    with pytest.raises(RecordingError, match='"episode_index" must hold a whole number in every row'):
        read(_episode(tmp_path, index, b'{"features": {}}'))


@pytest.mark.parametrize("info", [b'{"features": ' + b"[" * 100_000, b'{"features": {"a": {"names": [' + b"9" * 5000 + b"]}}}", b"\xff"])
def test_an_info_that_cannot_be_read_is_refused(tmp_path: Path, info: bytes) -> None:
    with pytest.raises(RecordingError, match=r"info\.json"):
        read(_episode(tmp_path, np.zeros(N, int), info))


def test_entries_of_one_name_go_by_their_numbers(tmp_path: Path) -> None:
    path = _episode(tmp_path, np.zeros(N, int), json.dumps({"features": {"observation.state": {"names": ["a", "a"]}}}).encode())
    columns = {"observation.state[0]": "piston.pressure_1 [bar]", "observation.state[1]": "knee.position [deg]"}
    is_the_table(read(path, foreign(columns)).recording)
