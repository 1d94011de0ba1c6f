"""Known limits of sensor scale: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.physics.effects import sensor_scale


def test_reads_in_proportion() -> None:
    assert sensor_scale.read(np.array([1.0, -2.0]), np.zeros(2), 1.1) == pytest.approx([1.1, -2.2])
