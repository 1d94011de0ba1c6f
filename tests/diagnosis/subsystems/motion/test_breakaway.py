"""Onsets count where it takes more to start a motion than to keep it up, and then a dip of friction is seen by them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import motion_runs, starts

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.policy.recordings import FEWEST_ONSETS
from exo_sim.diagnosis.subsystems.motion.breakaway import sliding_line, with_breakaway
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.recording.filters import gaussian_smoothed


def model_of(excess: float, noise: float = 0.05, arm: float = 1.0) -> MotionModel:
    run = starts.run(excess, noise)
    run = replace(run, drive=replace(run.drive, arm=np.full(starts.TIME.size, arm)))
    return MotionModel([run], motion_runs.plant(), Split({}))


def test_a_contact_that_starts_as_it_slides_has_no_onsets() -> None:
    model = model_of(0.0)
    assert with_breakaway(model) is model


@pytest.mark.parametrize("arm", [1.0, -0.5])
def test_one_that_takes_more_to_start_has_them_behind_its_rows(arm: float) -> None:
    model = model_of(10.0, arm=arm)
    found = with_breakaway(model) if arm > 0.0 else with_breakaway(turned(model))
    more = found.size - model.size
    assert more >= 10 and found.blocks.size == found.scale.size == found.speed.size == found.size
    np.testing.assert_allclose(found.residual({})[:-more], (model if arm > 0.0 else turned(model)).residual({}))
    friction = found.friction_of_rows()[-more:] * abs(arm)
    assert starts.LEVEL < np.median(friction) < starts.LEVEL + 10.0


def turned(model: MotionModel) -> MotionModel:
    """Return the balance of a lever that turns against its piston: the piston moves the other way."""
    (run,) = model.runs
    path = replace(run.kinematics, velocity=-run.kinematics.velocity)
    return MotionModel([replace(run, kinematics=path)], motion_runs.plant(), Split({}))


def test_noise_alone_makes_none() -> None:
    assert all(with_breakaway(model) is model for model in (model_of(0.0, noise) for noise in (0.5, 2.0)))


def test_a_balance_without_dry_friction_has_none() -> None:
    run = motion_runs.balance(30.0 * motion_runs.VELOCITY, 0.1)
    model = MotionModel([run], motion_runs.plant(), Split({}))
    assert with_breakaway(model) is model


def test_the_test_time_has_them_as_well() -> None:
    parts = Split({"recording": ((6.0, 12.0),)})
    found = with_breakaway(MotionModel([starts.run(10.0)], motion_runs.plant(), parts))
    late = found.on_test_time(parts)
    plain = MotionModel([starts.run(10.0)], motion_runs.plant(), parts, on_test=True)
    assert late.size > plain.size > 0


def lever_nears_zero(least: float, seed: int, excess: float = 0.0) -> MotionModel:
    """Return the balance of a joint whose lever is short in mid-travel, with force noise of 0.5."""
    run, noise = starts.run(), 0.5
    along = (starts.POSITION - starts.POSITION.min()) / np.ptp(starts.POSITION)
    arm = least + (1.0 - least) * (2.0 * along - 1.0) ** 2
    speed, phase = np.abs(starts.VELOCITY), starts.TIME % starts.STROKE
    sliding = np.sign(starts.VELOCITY) * (starts.LEVEL + excess * np.exp(-speed / starts.DIP)) + starts.DAMPING * starts.VELOCITY
    direction = np.where((starts.TIME // starts.STROKE) % 2 < 1, 1.0, -1.0)
    held = direction * (starts.LEVEL + excess) * (2.0 * phase / starts.REST - 1.0)
    lost = arm * np.where(phase > starts.REST, sliding, held) + noise * np.random.default_rng(seed).standard_normal(starts.TIME.size)
    external = run.inertia.force + gaussian_smoothed(starts.TIME, lost, 0.031)
    run = replace(run, external=external, drive=replace(run.drive, arm=arm), noise=0.2 * noise)
    return MotionModel([run], motion_runs.plant(), Split({}))


def test_a_lever_that_nears_zero_makes_no_breakaway() -> None:
    for seed in range(5):
        model = lever_nears_zero(0.001, seed)
        assert with_breakaway(model) is model
        assert with_breakaway(lever_nears_zero(0.001, seed, 10.0)).size > model.size


def one_way(excess: float) -> MotionModel:
    """Return the balance of a joint whose forces are known where it moves forwards alone."""
    run = starts.run(excess)
    return MotionModel([replace(run, known=(starts.TIME // starts.STROKE) % 2 < 1)], motion_runs.plant(), Split({}))


def test_of_motion_one_way_the_level_is_whole() -> None:
    model = one_way(0.0)
    assert (model.velocity > 0.0).all()
    line = sliding_line(model)
    assert line.constant == 0.0
    assert line.level == pytest.approx(starts.LEVEL, rel=0.02) and line.damping == pytest.approx(starts.DAMPING, rel=0.05)


def test_friction_that_falls_with_speed_all_along_has_no_negative_damping() -> None:
    run = starts.run(0.0)
    run = replace(run, external=run.external - 60.0 * run.kinematics.velocity)
    line = sliding_line(MotionModel([run], motion_runs.plant(), Split({})))
    assert line.damping == 0.0 and line.level < starts.LEVEL


def test_few_starts_that_scatter_are_no_breakaway() -> None:
    """Each start takes another force, 30 % about the level."""
    rng, found = np.random.default_rng(3), 0
    for _ in range(20):
        run = starts.run(0.0)
        stroke = (starts.TIME // starts.STROKE).astype(int)
        more = 0.3 * starts.LEVEL * rng.standard_normal(stroke.max() + 1)[stroke] * (np.abs(starts.VELOCITY) < 0.02)
        moves = starts.TIME % starts.STROKE > starts.REST
        lost = np.where(moves, np.sign(starts.VELOCITY) * more, 0.0)
        run = replace(run, external=run.external + gaussian_smoothed(starts.TIME, lost, 0.031))
        model = MotionModel([run], motion_runs.plant(), Split({}))
        found += with_breakaway(model) is not model
    assert found <= 1


def test_onsets_that_are_too_few_beside_those_that_crept_do_not_count() -> None:
    """Six starts, one of which creeps."""
    run, until = starts.run(10.0), starts.BEGINS[FEWEST_ONSETS - 1] * 1e-3 + 0.2
    first = starts.BEGINS[3]
    lost, window = run.external.copy(), slice(first - 60, first + 60)
    lost[window] *= 0.6
    model = MotionModel([replace(run, known=until > starts.TIME)], motion_runs.plant(), Split({}))
    crept = MotionModel([replace(run, external=lost, known=until > starts.TIME)], motion_runs.plant(), Split({}))
    assert with_breakaway(model).size == model.size + FEWEST_ONSETS
    assert with_breakaway(crept) is crept


@pytest.mark.parametrize(("velocity_noise", "creeps"), [(0.0, False), (1e-4, False), (1e-3, True)])
def test_onsets_are_no_reason_to_weigh_a_contact_that_creeps(velocity_noise: float, creeps: bool) -> None:
    """A row of an onset is one sample, and worth less than the mean of many: that is no noise of the velocity."""
    run = starts.run(10.0)
    run = replace(run, kinematics=replace(run.kinematics, velocity_noise=velocity_noise))
    model = MotionModel([run], motion_runs.plant(), Split({}))
    found = with_breakaway(model)
    assert found is not model
    assert model.with_contact(None, 0.02).creeps is found.with_contact(None, 0.02).creeps is creeps


def test_the_size_of_all_friction_does_not_hang_on_who_asked_before() -> None:
    asked, fresh = model_of(10.0), model_of(10.0)
    of_motion = asked.friction
    assert with_breakaway(asked).friction == with_breakaway(fresh).friction == of_motion
