"""Onsets count where it takes more to start a motion than to keep it up, and then a dip of friction is seen by them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import motion_runs, starts

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.subsystems.motion.breakaway import with_breakaway
from exo_sim.diagnosis.subsystems.motion.model import MotionModel


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
