"""The phase of the stride from encoders: found from a wrong start, kept when the cadence changes, not moved by offsets and noise."""

import numpy as np
import pytest

from exo_sim.control.gait_phase import PhaseObserver

PERIOD, DT = 1.05, 0.002


def angles(phase):
    """Something like an angle between the thighs and two knees."""
    turn = 2 * np.pi * np.asarray(phase)
    knees = [0.5 * np.cos(turn + shift) + 0.2 * np.cos(2 * turn + 1.0 + 2 * shift) for shift in (0.0, np.pi)]
    return np.stack([0.6 * np.sin(turn), *knees], axis=-1)


@pytest.fixture
def observer():
    return PhaseObserver(angles(np.arange(64) / 64), PERIOD)


def followed(observer, phase, change=lambda shown, k: shown):
    """Return the error of the phase over a true one, in cycles."""
    out = []
    for k, true in enumerate(phase):
        out.append(observer.step(change(angles(true), k), DT if k else 0.0) - true)
    return np.array(out)


def test_it_stays_where_the_calibration_was(observer):
    error = followed(observer, np.arange(5000) * DT / PERIOD)
    assert np.abs(error).max() < 0.005


@pytest.mark.parametrize("start", [-0.1, 0.03, 0.1])
def test_a_wrong_start_is_put_right_within_two_strides(observer, start):
    observer.start(start)
    error = followed(observer, np.arange(5000) * DT / PERIOD)
    assert np.abs(error[round(2 * PERIOD / DT) :]).max() < 0.01


@pytest.mark.parametrize("factor", [0.85, 1.1, 1.2])
def test_another_cadence_is_found(observer, factor):
    error = followed(observer, np.arange(5000) * DT / PERIOD * factor)
    assert np.abs(error[round(4 * PERIOD / DT) :]).max() < 0.01
    assert observer.cadence == pytest.approx(factor / PERIOD, rel=0.03)


def test_offsets_and_noise_of_encoders_move_it_little(observer):
    noise = np.random.default_rng(1).normal(0.0, 0.01, (5000, 3))
    offset = np.radians([6.0, -3.0, 3.0])
    error = followed(observer, np.arange(5000) * DT / PERIOD, lambda shown, k: shown + offset + noise[k])
    assert np.abs(error[-round(3 * PERIOD / DT) :]).max() < 0.015


def test_a_wearer_who_stands_still_leaves_it_to_the_clock():
    observer = PhaseObserver(np.zeros((64, 4)) + 0.3, PERIOD)
    for _ in range(525):
        observer.step(np.full(4, 0.31), DT)
    assert observer.phase == pytest.approx(525 * DT / PERIOD)


def test_it_uses_no_sample_before_it_is_there(observer):
    """Two encoders that part at a time give the same phase until then."""
    other = PhaseObserver(angles(np.arange(64) / 64), PERIOD)
    truth = np.arange(1000) * DT / PERIOD
    one = followed(observer, truth)
    two = followed(other, truth, lambda shown, k: shown + (0.5 if k >= 700 else 0.0))
    np.testing.assert_array_equal(one[:700], two[:700])
    assert np.abs(one[700:] - two[700:]).max() > 1e-3
