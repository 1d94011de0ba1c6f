"""Writing for the viewer imports no pandas, and pandas is there for who asks."""

from __future__ import annotations

import subprocess
import sys

import pytest

WRITTEN = """
import sys
import numpy as np
from exo_sim.recording.rrd_file import write_rrd
from exo_sim.recording.table import Recording
write_rrd(sys.argv[1], Recording("one", np.arange(3.0), {"knee.pressure_1": np.ones(3)}, {"knee.pressure_1": "Pa"}))
print("pandas" in sys.modules)
import pyarrow as pa
frame = pa.table({"a": [1, 2]}).to_pandas()
print(list(frame["a"]), pa.array(frame["a"]).to_pylist())
"""


def test_a_recording_is_written_without_pandas_which_is_there_after(tmp_path):
    pytest.importorskip("pandas")
    done = subprocess.run([sys.executable, "-c", WRITTEN, str(tmp_path / "one.rrd")], capture_output=True, text=True, check=True)
    assert done.stdout.split("\n")[:2] == ["False", "[1, 2] [1, 2]"]
