"""Regimes of a motion: out and in, fast and slowly."""

from __future__ import annotations

import numpy as np

from exo_sim.diagnosis.subsystems.motion.regimes import regimes

TIME = np.arange(4000, dtype=float) * 1e-3
VELOCITY = np.sin(2.0 * np.pi * TIME)


def test_a_sine_is_fast_a_quarter_of_the_time_and_slow_four_tenths() -> None:
    found = regimes(VELOCITY, TIME)
    assert abs(found["moving fast"].mean() - 0.25) < 0.01 and abs(found["moving slowly"].mean() - 0.40) < 0.01
    assert not (found["moving fast"] & found["moving slowly"]).any()
    assert not (found["moving out"] & found["moving in"]).any()
    assert np.abs(VELOCITY[found["moving fast"]]).min() >= np.abs(VELOCITY[found["moving slowly"]]).max()


def test_reversals_are_where_the_velocity_changes_its_sign() -> None:
    near = regimes(VELOCITY, TIME)["near a reversal"]
    assert near[np.searchsorted(TIME, 0.5)] and not near[np.searchsorted(TIME, 0.75)]
    assert np.abs(VELOCITY[near]).max() < np.sin(2.0 * np.pi * 0.06)
