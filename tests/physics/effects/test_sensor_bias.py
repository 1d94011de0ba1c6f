"""Known limits of sensor bias: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.physics.effects import sensor_bias


def test_reads_more_by_the_bias() -> None:
    assert sensor_bias.read(np.array([1.0, 2.0]), np.zeros(2), 0.5) == pytest.approx([1.5, 2.5])
