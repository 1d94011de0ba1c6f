"""One small table, and how a reader is asked for it by a column map."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from exo_sim.recording import Recording
from exo_sim.recording.column_map import column_map_of

N = 200
TIME = np.arange(N, dtype=np.float64) * 0.01
PRESSURE = 2e5 + 1e4 * np.sin(TIME)
ANGLE = 0.3 * np.cos(TIME)
HEADINGS = ["time [s]", "piston.pressure_1 [bar]", "knee.position [deg]"]
TABLE = np.column_stack([TIME, PRESSURE / 1e5, np.rad2deg(ANGLE)])


def foreign(columns: dict[str, Any], **options: Any) -> Any:
    return column_map_of({"columns": columns, "file": options}, Path("map.toml"))


def is_the_table(recording: Recording, shift: float = 0.0) -> None:
    np.testing.assert_allclose(recording.time, TIME - shift, atol=1e-9)
    np.testing.assert_allclose(recording["piston.pressure_1"], PRESSURE, rtol=1e-12)
    np.testing.assert_allclose(recording["knee.position"], ANGLE, atol=1e-12)
