"""The balance of forces as a least-squares problem: what is missing, what is named, and what looks alike."""

from __future__ import annotations

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest
from diagnosis import motion_runs
from diagnosis.motion_runs import ACCELERATION, MASS, POSITION, TIME, VELOCITY

from exo_sim.diagnosis.data.motion_run import Imputed
from exo_sim.diagnosis.data.split import Split, split
from exo_sim.diagnosis.estimation.least_squares import fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.policy.off_nominal import MASS_FORM
from exo_sim.diagnosis.policy.validation import HELD_OUT_SHARE, TEST_SHARE
from exo_sim.diagnosis.subsystems.motion.candidates import candidates
from exo_sim.diagnosis.subsystems.motion.full_scale import full_force
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.nuisances import nuisance_parameters, with_damping, with_damping_if_too_large

PARTS = Split({})


def model_of(lost: np.ndarray, noise: float = 0.3) -> MotionModel:
    return MotionModel([motion_runs.balance(lost, noise)], motion_runs.plant(), PARTS)


def test_what_the_balance_lacks_is_what_was_lost_with_the_opposite_sign() -> None:
    lost = 4.0 * np.sin(5.0 * TIME)
    model = model_of(lost, 0.0)
    np.testing.assert_allclose(model.missing(model.nominal, 0), -lost, atol=1e-9)
    assert model.unit == "N" and model.where == "slide" and not model.has_imputed_pressure


def test_a_sensor_mass_or_offset_that_is_off_is_in_it() -> None:
    model = model_of(np.zeros(TIME.size), 0.0)
    heavier = replace(model.nominal, sensors={"payload_mass": 1.1, "offset": 2.0})
    np.testing.assert_allclose(model.missing(heavier, 0), 0.1 * MASS * ACCELERATION - 2.0, atol=1e-9)


def test_samples_at_rest_and_around_reversals_are_no_rows() -> None:
    model = model_of(np.zeros(TIME.size))
    (comparison,) = model.compared(model.nominal, model.nominal)
    assert 0.5 * TIME.size < comparison.error_before.size < TIME.size
    assert model.size == pytest.approx(comparison.error_before.size / 20, rel=0.05)
    assert np.sqrt(np.mean(model.residual({}) ** 2)) == pytest.approx(1.0, abs=0.6)


def test_the_force_that_is_missing_is_a_curve_of_what_it_follows() -> None:
    model = model_of(5.0 * np.exp(-((POSITION / 0.02) ** 2)), 0.1)
    (missing,) = model.discrepancies(model.nominal)
    assert missing.best is not None and missing.best.variable == "position" and missing.acts == "force"
    assert missing.best(np.zeros(1))[0] == pytest.approx(-5.0, abs=0.8)
    assert model.column("position") == "slide.position" and model.column("time") == "time"
    plain, curved = (model.compared(model.nominal, model.nominal, curve)[0] for curve in (None, missing.best))
    assert np.std(curved.error_after) < 0.3 * np.std(plain.error_after)


def test_test_time_has_rows_of_its_own() -> None:
    parts = split([("recording", TIME)])
    model = MotionModel([motion_runs.balance(np.zeros(TIME.size), 0.3)], motion_runs.plant(), parts)
    tested = model.on_test_time(parts)
    assert tested.size == pytest.approx(model.size * TEST_SHARE * HELD_OUT_SHARE / (1.0 - HELD_OUT_SHARE), rel=0.25)
    (comparison,) = tested.compared(model.nominal, model.nominal)
    assert comparison.error_before.size < 0.2 * TIME.size


def test_all_friction_is_what_the_rig_knows_and_what_it_lacks() -> None:
    resisted = motion_runs.balance(12.0 * np.sign(VELOCITY), 0.1)
    ignorant, knowing = motion_runs.plant(), motion_runs.plant()
    knowing.cylinder["coulomb_friction"]["force"] = 12.0
    sizes = [MotionModel([resisted], plant, PARTS).friction for plant in (ignorant, knowing)]
    assert sizes == pytest.approx([12.0, 12.0], rel=0.15)
    run = motion_runs.behind_cylinder(motion_runs.balance(np.zeros(TIME.size), 0.01), np.zeros((TIME.size, 2)))
    free = MotionModel([run], motion_runs.plant(), PARTS)
    assert free.friction == free.healthy_friction == pytest.approx(0.002 * full_force(run, motion_runs.plant()))


def test_what_an_imputed_pressure_leaves_open_is_free_in_the_balance() -> None:
    response, leak = 3.0 * np.sin(2.0 * TIME), 1e9 * np.ones(TIME.size)
    gauge = np.zeros((TIME.size, 2))
    run = motion_runs.behind_cylinder(motion_runs.balance(-2.0 * response, 0.1), gauge)  # less than the predicted pressure gives
    run = replace(run, imputed=Imputed({"start of recording": response}, {"area_2": leak}))
    model = MotionModel([run], motion_runs.plant(), PARTS)
    nuisances = nuisance_parameters(model.runs, model.nominal, model.where)
    names = {q.parameter for q in nuisances}
    assert model.has_imputed_pressure and {"start of recording", "area_2"} <= names
    found = fit(model.residual, nuisances, {q: q.start for q in nuisances})
    size = next(value for q, value in found.values.items() if q.parameter == "start of recording")
    assert size == pytest.approx(2.0, abs=0.3)
    assert {c.effect for c in candidates(model.runs, model.nominal, model.where)} >= {"external_leakage", "coulomb_friction"}


def test_damping_is_freed_only_where_it_is_plainly_too_large() -> None:
    """The owner believes 40 N s/m."""
    for true, freed in ((40.0, False), (12.0, True)):
        run = motion_runs.balance(true * VELOCITY, 0.3)
        damping = -40.0 * VELOCITY
        run = replace(run, passive=replace(run.passive, force=damping, damping=damping))
        model = MotionModel([run], motion_runs.plant(), PARTS)
        nuisances = nuisance_parameters(model.runs, model.nominal, model.where)
        more = with_damping_if_too_large(model, nuisances)
        assert (len(more) > len(nuisances)) == freed
        assert len(with_damping(model, nuisances)) == len(nuisances) + 1
        if freed:
            found = fit(model.residual, more, {q: q.start for q in more})
            assert found.values[more[-1]] == pytest.approx(0.3, abs=0.02)


def test_a_model_that_nobody_asks_any_more_holds_no_memory() -> None:
    """An hour's arrays hang on it: they cannot wait until the collector comes by."""
    gc.disable()
    try:
        model = model_of(np.zeros(TIME.size))
        model.residual({})
        gone = weakref.ref(model)
        del model
        assert gone() is None
    finally:
        gc.enable()


def test_a_mass_is_known_no_better_than_the_laws_of_friction_leave_it() -> None:
    model = model_of(np.zeros(TIME.size))
    mass = FreeParameter("payload_mass", "slide", "payload_mass", "1", Target.SENSOR, 0.1, 0.1, 10.0, (1.0, 0.1), neutral=1.0)
    friction = FreeParameter("coulomb_friction", "slide", "force", "N", Target.CYLINDER, 1.0, 0.0, 50.0)
    assert model.error_of_form(mass, 0.01, {}) == pytest.approx(0.01 * MASS_FORM)
    assert model.error_of_form(friction, 0.01, {}) == 0.0
