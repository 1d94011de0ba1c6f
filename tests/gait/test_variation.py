"""Strides that are not the mean one: their times, their sides, and that posture and progress stay those of a walk."""

import dataclasses

import numpy as np
import pytest

from exo_sim.errors import ScenarioError
from exo_sim.gait import scenario, scenario_file
from exo_sim.gait.motion import SAMPLES, reference
from exo_sim.gait.variation import Variation
from exo_sim.machine.person import Person

STRIDES = 16


@pytest.fixture(scope="module")
def walk():
    return scenario.motion("level_walk", Person(), 1.0)


def path(motion):
    """Return coordinates and rates at evenly spaced times over all strides, as the simulation reads them."""
    position, slope = motion.tables()
    out = np.empty((2, 4000, 9))
    for i, cycles in enumerate(np.arange(4000) / 4000):
        reference(cycles, motion.period, motion.advance, motion.climb, position, slope, out[0, i], out[1, i])
    return out, np.arange(4000) / 4000 * motion.period


def test_no_variation_is_the_mean_stride(walk):
    same = Variation().applied(walk, STRIDES)
    assert same.strides == 1
    np.testing.assert_array_equal(same.position, walk.position)


def test_stride_times_have_the_spread_asked_for(walk):
    """Times between the moments at which the right foot takes over, of many seeds."""
    found = []
    for seed in range(40):
        carried = Variation(stride_time=0.02, seed=seed).applied(walk, STRIDES).share[:, 1] > 0.5
        taken = np.flatnonzero(carried & ~np.roll(carried, 1))
        assert len(taken) == STRIDES
        found += list(np.diff(np.append(taken, taken[0] + len(carried))) / SAMPLES)
    assert np.mean(found) == pytest.approx(1.0, abs=2e-3)
    assert np.std(found) == pytest.approx(0.02, rel=0.2)


def test_steps_of_left_and_right_have_the_times_asked_for(walk):
    lame = Variation(asymmetry=0.1).applied(walk, STRIDES)
    assert lame.strides == 1
    heavier = lame.share[:, 1] > lame.share[:, 0]
    even = walk.share[:, 1] > walk.share[:, 0]
    assert heavier.mean() - even.mean() == pytest.approx(0.05, abs=0.01)


def test_rates_are_those_of_the_path_and_the_advance_is_the_same(walk):
    varied = Variation(stride_time=0.02, seed=3).applied(walk, STRIDES)
    assert varied.strides == STRIDES and len(varied.position) == STRIDES * SAMPLES
    (q, v), time = path(varied)
    numeric = np.gradient(q, time, axis=0)
    np.testing.assert_allclose(v[2:-2], numeric[2:-2], atol=0.02 * np.abs(v).max())
    assert varied.advance == pytest.approx(STRIDES * walk.advance)
    rate = np.fft.irfft(np.fft.rfft(varied.slope[:, 3:], axis=0) * 2j * np.pi * np.arange(len(varied.slope) // 2 + 1)[:, None],
                        len(varied.slope), axis=0)  # fmt: skip
    np.testing.assert_allclose(varied.curvature[:, 3:], rate, atol=1e-3 * np.abs(varied.curvature[:, 3:]).max())


def test_a_foot_on_the_ground_stays_as_well_as_in_the_mean_stride(walk):
    """Time is warped, not posture: every posture is one of the mean stride, at the place that belongs to it."""
    varied = Variation(stride_time=0.03, seed=1).applied(walk, STRIDES)
    (q, _), _ = path(varied)
    legs = walk.position[:, 3:]
    for row in q[::97]:
        assert np.abs(legs - row[3:]).max(axis=1).min() < np.radians(0.5)  # half a sample of the table
    assert np.ptp(q[:, 1]) == pytest.approx(np.ptp(walk.position[:, 1]), rel=0.02)


def test_leaning_turns_the_trunk_and_leaves_the_legs_in_space(walk):
    leant = Variation(lean=np.radians(3.0)).applied(walk, STRIDES)
    np.testing.assert_allclose(walk.position[:, 2] - leant.position[:, 2], np.radians(3.0))
    for hip in (3, 6):
        np.testing.assert_allclose(leant.position[:, 2] + leant.position[:, hip], walk.position[:, 2] + walk.position[:, hip])


def test_the_same_seed_gives_the_same_strides(walk):
    one, two, other = (Variation(stride_time=0.02, seed=seed).applied(walk, STRIDES).position for seed in (1, 1, 2))
    np.testing.assert_array_equal(one, two)
    assert np.abs(one - other).max() > 1e-3


@pytest.mark.parametrize("wrong", [{"stride_time": 0.2}, {"stride_time": -0.1}, {"asymmetry": 0.5}, {"lean": 1.0}])
def test_more_than_anybody_walks_with_is_refused(wrong):
    with pytest.raises(ScenarioError, match=f"variation: {next(iter(wrong))}"):
        Variation(**wrong)


def test_a_scenario_file_says_it(tmp_path):
    file = tmp_path / "uneven.toml"
    file.write_text('like = "level_walk"\n[variation]\nstride_time = 0.02\nasymmetry = 0.05\nlean = "3 deg"\nseed = 4\n')
    varied = scenario_file.read(file).variation
    assert varied is not None
    assert dataclasses.astuple(varied) == pytest.approx((0.02, 0.05, np.radians(3.0), 4))
    file.write_text('like = "level_walk"\n[variation]\nstride_tim = 0.02\n')
    with pytest.raises(ScenarioError, match="stride_time"):
        scenario_file.read(file)
    file.write_text('like = "level_walk"\n[variation]\nstride_time = 0.5\n')
    with pytest.raises(ScenarioError, match=r"uneven\.toml: variation: stride_time"):
        scenario_file.read(file)
