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
