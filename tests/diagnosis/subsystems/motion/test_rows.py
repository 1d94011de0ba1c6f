"""Rows of a balance of forces: whole groups of samples that move, away from turns, breaks and what is held out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import motion_runs

from exo_sim.diagnosis.policy.recordings import FILTER_ENDS
from exo_sim.diagnosis.subsystems.motion.rows import BLOCK, GROUP, rows_of
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothing_width
from exo_sim.recording.filters import gaussian_width

N = motion_runs.TIME.size
ALL = np.ones(N, dtype=bool)
RUN = motion_runs.balance(np.zeros(N), noise=1.0)


def test_a_row_is_the_mean_of_a_whole_group_that_moves() -> None:
    rows = rows_of(RUN, ALL)
    size = round(GROUP / 1e-3)
    assert (np.bincount(rows.group[rows.compared]) == size).all()
    assert (np.abs(RUN.kinematics.velocity[rows.compared]) > RUN.kinematics.still).all()
    np.testing.assert_allclose(rows.means(motion_runs.TIME)[0], motion_runs.TIME[rows.group == 0].mean())
    np.testing.assert_array_equal(rows.block, [int(motion_runs.TIME[rows.group == i][0] / BLOCK) for i in range(len(rows.block))])


def test_weights_are_the_means_as_a_matrix() -> None:
    rows, values = rows_of(RUN, motion_runs.TIME < 4.0), np.random.default_rng(2).standard_normal(N)
    assert rows.weights().shape == (len(rows.block), N)
    np.testing.assert_allclose(rows.weights() @ values, rows.means(values), rtol=1e-12)


def test_nothing_is_compared_within_half_a_filter_of_a_turn_or_break() -> None:
    reach = int(0.5 * smoothing_width(motion_runs.TIME) / 1e-3)
    rows = rows_of(replace(RUN, breaks=(0, 4000)), ALL)
    turns = np.flatnonzero(np.diff(np.signbit(RUN.kinematics.velocity)))
    for at in (*turns, 4000):
        assert not rows.compared[max(0, at - reach + 1) : at + reach].any()


def test_beside_an_end_of_a_recording_that_moves_the_filter_says_nothing() -> None:
    """A recording that was cut out of a swing: behind the filter it seems to start from rest."""
    ends = int(FILTER_ENDS * gaussian_width(smoothing_width(motion_runs.TIME)) / 1e-3)
    even = replace(RUN, breaks=(0, 4000), kinematics=replace(RUN.kinematics, velocity=np.full(N, 0.2)))
    compared = rows_of(even, ALL).compared
    for at in (0, 4000, N):
        assert not compared[max(0, at - ends + 1) : at + ends].any()
    assert compared.mean() > 0.9


def test_what_breaks_loose_inside_the_filter_is_not_compared() -> None:
    """Friction at the mean speed of a jump is no mean friction of it."""
    jump = 0.051 + 0.05 * np.tanh((motion_runs.TIME - 4.0) / 4e-3)
    rows = rows_of(replace(RUN, kinematics=replace(RUN.kinematics, velocity=jump, still=1e-4)), ALL)
    begins = (motion_runs.TIME > 3.98) & (motion_runs.TIME < 4.0)
    assert not rows.compared[begins].any()
    assert rows.compared[(motion_runs.TIME > 2.0) & (motion_runs.TIME < 3.9)].all()


def test_unusable_time_and_missing_values_are_left_out() -> None:
    usable = ALL.copy()
    usable[5000:] = False
    external = RUN.external.copy()
    external[1000:1010] = np.nan
    rows = rows_of(replace(RUN, external=external), usable)
    assert not rows.compared[5000:].any() and not rows.compared[1000:1010].any() and rows.compared[:5000].any()


def test_the_scale_follows_the_noise() -> None:
    loud, quiet = rows_of(replace(RUN, noise=500.0), ALL), rows_of(replace(RUN, noise=1.0), ALL)
    assert loud.scale[0] > 10.0 * quiet.scale[0] and (loud.scale == loud.scale[0]).all()
    assert 500.0 * np.sqrt(3.0 / 20.0) == pytest.approx(loud.scale[0], rel=0.01)
