"""Strides are found where feet strike, by the angles and by the ground."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from gait.walked_trial import PERIOD, walked

from exo_sim.errors import ScenarioError
from exo_sim.gait.strides import CONTACT_FORCE, find
from exo_sim.gait.walking_trial import GroundForce


def pressed(starts: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Return 700 N for 0.65 s from each start on."""
    return np.asarray(sum(700.0 * ((time >= start) & (time < start + 0.65)) for start in starts), dtype=float)


def test_angles_tell_period_and_stance() -> None:
    found = find(walked(5))
    assert not found.by_force and found.path is None
    assert found.period == pytest.approx(PERIOD, rel=0.01) and 0.55 < found.stance_end < 0.7
    assert {side for side, _, _ in found.spans} == {"l", "r"}
    assert all(values.shape == (len(found.spans), 100) for values in found.angles.values())


def test_plates_tell_it_more_exactly_whosever_they_are() -> None:
    trial = walked(5)
    time = np.arange(0.0, 5 * PERIOD, 0.001)
    right, left = np.arange(1, 5) * PERIOD, (np.arange(0, 5) + 0.5) * PERIOD
    found = find(trial, GroundForce("plates.csv", time, {"one": pressed(right, time), "two": pressed(left, time)}))
    assert found.by_force and found.period == pytest.approx(PERIOD, abs=1e-3)
    assert found.stance_end == pytest.approx(0.65 / PERIOD, abs=2e-3)
    assert min(start for side, start, _ in found.spans if side == "r") == pytest.approx(PERIOD, abs=2e-3)
    assert CONTACT_FORCE < 700.0


def test_plates_of_another_time_are_refused() -> None:
    time = np.arange(20.0, 22.0, 0.001)
    with pytest.raises(ScenarioError, match=r"plates\.csv: lasts from 20\.00"):
        find(walked(), GroundForce("plates.csv", time, {"one": pressed(np.array([20.5]), time)}))


def test_half_a_stride_is_none() -> None:
    trial = walked()
    few = slice(0, 40)
    short = replace(trial, time=trial.time[few], angles={name: values[few] for name, values in trial.angles.items()})
    with pytest.raises(ScenarioError, match=r"no whole stride in 0\.39 s"):
        find(short)
