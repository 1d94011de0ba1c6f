"""The value at the start of a window: less noisy than one sample where there are many, never off by how the gas bends."""

from __future__ import annotations

import math

import numpy as np
import pytest

from exo_sim.recording.start_value import FEWEST, MOST, SPAN, start_points, start_value


@pytest.mark.parametrize(("rate", "points"), [(5000.0, MOST), (1000.0, MOST), (800.0, 13), (400.0, 1), (20.0, 1)])
def test_it_takes_many_samples_of_a_short_time_or_one(rate: float, points: int) -> None:
    time = np.arange(200) / rate
    assert start_points(time) == points
    assert points == 1 or (time[points - 1] <= SPAN * 1.001 and points >= FEWEST)


def test_a_parabola_is_returned_as_it_begins_and_noise_is_less() -> None:
    time = np.arange(MOST) * 1e-3
    curve = 3e5 + 2e6 * time - 4e8 * time**2
    assert start_value(curve, MOST) == pytest.approx(3e5)
    noise = np.random.default_rng(2).normal(0.0, 100.0, (2000, MOST))
    left = np.std([start_value(each, MOST) for each in noise])
    assert left == pytest.approx(100.0 * math.sqrt(1896.0 / 4080.0), rel=0.05)


def test_missing_samples_are_passed_over() -> None:
    values = np.arange(20.0)
    values[:3] = np.nan
    assert start_value(values, MOST) == 3.0
    assert start_value(values[3:7], MOST) == 3.0
    assert math.isnan(start_value(np.full(4, np.nan), MOST))
