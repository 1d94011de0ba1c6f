"""Known limits of sensor delay: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.physics.effects import sensor_delay


def test_reads_what_was() -> None:
    time = np.arange(0.0, 1.0, 1e-3)
    late = sensor_delay.read(np.sin(7 * time), time, 0.0155)
    assert late[20:] == pytest.approx(np.sin(7 * (time[20:] - 0.0155)), abs=1e-5)
    assert late[0] == 0.0
