"""What cylinders can follow against what a task asks for."""

from types import SimpleNamespace

import numpy as np
import pytest

from exo_sim.sizing.force_bandwidth import FREQUENCIES, force_bandwidths, needed


def test_power_of_a_known_signal():
    time = np.arange(0.0, 2.0, 1e-3)
    slow = np.sin(2 * np.pi * 1.0 * time)
    assert needed(5.0 + slow, 1e-3) == pytest.approx(1.0)
    assert needed(slow + np.sin(2 * np.pi * 8.0 * time), 1e-3) == pytest.approx(8.0)
    assert needed(np.full(2000, 3.0), 1e-3) == 0.0


def test_a_larger_force_is_followed_less_fast_and_one_that_is_not_asked_for_is_left_out(exo):
    time = np.arange(0.0, 2.0, 1e-3)

    def walk(amplitude):
        demand = amplitude * np.sin(2 * np.pi * time)
        columns = {"hip_r.force_demanded": demand, "knee_r.force_demanded": np.zeros(len(time))}
        return SimpleNamespace(rig=exo, motion=SimpleNamespace(period=1.0), step=1e-3, time=time, columns=columns)

    (small,), (large,) = (force_bandwidths(walk(amplitude), ("hip_r", "knee_r")) for amplitude in (100.0, 2500.0))
    assert (large.name, large.needed) == ("hip_r", pytest.approx(1.0)) and large.amplitude == pytest.approx(2500.0, rel=1e-3)
    assert large.needed < large.hertz < small.hertz <= FREQUENCIES[-1]
