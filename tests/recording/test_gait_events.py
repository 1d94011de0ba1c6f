"""Contacts of a foot from its vertical force: strides of known length, chatter closed, and stance where no force was recorded."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.recording import Recording
from exo_sim.recording.gait_events import feet

TIME = np.arange(6000.0) * 1e-3
PHASE = TIME % 1.2
FORCE = np.where(PHASE < 0.72, 800.0 * np.sin(np.pi * PHASE / 0.72), 0.0)


def one(**columns: np.ndarray) -> Recording:
    return Recording("walk", TIME, {key.replace("__", "."): values for key, values in columns.items()}, {})


def test_strides_are_as_long_as_they_are() -> None:
    (foot,) = feet(one(foot_r__ground_force_z=FORCE))
    assert foot.foot == "foot_r" and foot.peak_force == pytest.approx(800.0)
    assert foot.stride_times == pytest.approx(1.2, abs=2e-3) and len(foot.contacts) == 5
    assert foot.stance_share == pytest.approx(0.6, abs=0.04)


def test_chatter_is_no_step() -> None:
    rattling = FORCE * ~((PHASE > 0.30) & (PHASE < 0.33))
    assert feet(one(foot_r__ground_force_z=rattling))[0].contacts == feet(one(foot_r__ground_force_z=FORCE))[0].contacts


def test_recorded_stance_counts_only_where_no_force_does() -> None:
    stance = (PHASE < 0.72).astype(float)
    right, left = feet(one(gait__stance_r=stance, gait__stance_l=1.0 - stance))
    assert (right.foot, left.foot) == ("right foot", "left foot") and right.peak_force is None
    assert right.contacts[0] == pytest.approx(left.leaves[0]) and right.stride_times == pytest.approx(1.2, abs=2e-3)
    assert [f.foot for f in feet(one(foot__ground_force_z=FORCE, gait__stance_r=stance))] == ["foot"]
