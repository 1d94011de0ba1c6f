"""Scatter of a contact that hardly slides: estimated by speed, and no reason to distrust rows that slide."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import motion_runs
from diagnosis.motion_runs import TIME

from exo_sim.diagnosis.data.split import Split, split
from exo_sim.diagnosis.subsystems.motion.contact_scatter import contact_scatter, friction_of_noise
from exo_sim.diagnosis.subsystems.motion.model import MotionModel

SPEED = np.geomspace(1e-3, 0.3, 600)
NOISE = np.random.default_rng(4).standard_normal(SPEED.size)


def test_rows_of_one_noise_do_not_scatter() -> None:
    assert contact_scatter(NOISE, SPEED) is None
    assert contact_scatter(NOISE[:50], SPEED[:50]) is None


def test_the_factor_is_the_ratio_of_standard_deviations_and_falls_with_speed() -> None:
    true = 1.0 + 7.0 * (SPEED < 5e-3)
    found = contact_scatter(true * NOISE, SPEED)
    assert found is not None and (np.diff(found.factors) <= 0.0).all()
    assert found.at(np.array([2e-3]))[0] == pytest.approx(8.0, rel=0.3)
    assert found.at(np.array([0.1]))[0] == pytest.approx(1.0, abs=0.2)
    assert 3e-3 < found.settles_at() < 8e-3


def test_what_is_left_of_a_contact_that_slides_is_no_scatter() -> None:
    assert contact_scatter((1.0 + 7.0 * (SPEED > 0.1)) * NOISE, SPEED) is None


def test_rows_of_a_model_are_worth_less_where_the_contact_scatters() -> None:
    parts = split([("recording", TIME)])
    model = MotionModel([motion_runs.balance(np.zeros(TIME.size), 0.3)], motion_runs.plant(), parts)
    scatter = contact_scatter((1.0 + 9.0 * (SPEED < 2e-2)) * NOISE, SPEED)
    assert scatter is not None
    less = model.with_contact(scatter)
    np.testing.assert_allclose(less.scale, model.scale * scatter.at(model.speed))
    np.testing.assert_allclose(less.residual({}) * less.scale, model.residual({}) * model.scale)
    tested = less.on_test_time(parts)
    np.testing.assert_allclose(tested.scale, model.on_test_time(parts).scale * scatter.at(tested.speed))
    assert less.noise == model.noise and less.scale.max() > 3.0 * less.scale.min()
    assert model.with_contact(None) is model and MotionModel(model.runs, model.nominal, Split({})).slowest_resolved == 0.0


def test_noise_of_the_velocity_counts_where_friction_builds_up() -> None:
    """F = F_c tanh(v/c): a noise of the velocity is worth F_c/c of it where the piston creeps, and nothing where it slides."""
    plain = motion_runs.balance(10.0 * np.sign(motion_runs.VELOCITY), 0.3)
    run = replace(plain, kinematics=replace(plain.kinematics, velocity_noise=2e-2))
    model = MotionModel([run], motion_runs.plant(), Split({}))
    creep = float(np.percentile(model.speed, 20.0))
    less = model.with_contact(None, creep)
    slope = model.friction / creep / np.cosh(model.speed / creep) ** 2
    np.testing.assert_allclose(less.scale, np.hypot(model.scale, 2e-2 * slope))
    assert less.creeps and not model.creeps
    assert less.scale[np.argmax(model.speed)] == pytest.approx(model.noise, rel=0.01)
    np.testing.assert_allclose(less.residual({}) * less.scale, model.residual({}) * model.scale)
    assert not MotionModel([plain], motion_runs.plant(), Split({})).with_contact(None, creep).creeps


def test_noise_of_the_velocity_moves_friction_by_the_slope_at_which_it_builds_up() -> None:
    speed, step = np.array([0.0, 1e-3, 2e-3, 0.5]), 1e-7
    slope = 30.0 * (np.tanh((speed + step) / 2e-3) - np.tanh((speed - step) / 2e-3)) / (2.0 * step)
    assert friction_of_noise(30.0, speed, np.full(4, 1e-4), 2e-3) == pytest.approx(1e-4 * slope, rel=1e-5, abs=1e-12)
