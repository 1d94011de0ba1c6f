"""A sensor's fault that the gas gave away is taken off the forces: the drive is then what it truly was."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import benches
import mujoco
import numpy as np
import pytest

from exo_sim.diagnosis import library
from exo_sim.diagnosis.cases import Case
from exo_sim.diagnosis.chamber_pressure import LEAST, carried_over
from exo_sim.diagnosis.fitting import Fit
from exo_sim.diagnosis.gas_problem import GasProblem
from exo_sim.diagnosis.judging import Judged
from exo_sim.diagnosis.motion_cut import MotionRun, motion_runs
from exo_sim.diagnosis.observed import cylinder_runs
from exo_sim.diagnosis.quantity import Candidate, Setting
from exo_sim.diagnosis.rod_cut import rod_run
from exo_sim.diagnosis.search import Trial
from exo_sim.diagnosis.split import Split
from exo_sim.machine.linkage import linkages
from exo_sim.machine.load import load
from exo_sim.recording import Recording
from exo_sim.rig import Rig, assembly

PARTS = Split({})
INSIDE = slice(60, -60)


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return benches.bench(tmp_path_factory.mktemp("carried"))


@pytest.fixture(scope="module")
def truth(rig: Rig) -> Recording:
    """A piston led to and fro that breathes through nothing."""
    return benches.led(rig, 1.5)


def case_of(rig: Rig, table: Recording) -> Case:
    model: mujoco.MjModel = load(rig)
    links = linkages(rig, model)
    joints = {"slide": motion_runs(table, rig, model, links)[0]}
    return Case(rig, model, links, [table], {"piston": cylinder_runs(table, rig, model, links)}, joints)


def judged(case: Case, effect: str, value: float, side: int = 1, position: bool = False, **more: Any) -> Judged:
    """Return what the gas says once a sensor's fault has been found in it."""
    setting = Setting(assembly.world(case.rig), assembly.cylinders(case.rig))
    problem = GasProblem(case.cylinders["piston"], setting, PARTS)
    column = "slide.position" if position else f"piston.pressure_{side}"
    named: Candidate = next(
        c for c in library.candidates(setting, case.cylinders["piston"], "piston", "slide") if (c.effect, c.where) == (effect, column)
    )
    trial = Trial((named,), Fit(named.quantities, {named.quantities[0]: value}, np.zeros(problem.size), np.zeros((problem.size, 1))))
    fields: dict[str, Any] = {"named": (named,), "nameless": False, **more}
    return Judged("gas", "piston", problem, None, None, fields["named"], trial, fields["nameless"], [], [], [])  # type: ignore[arg-type]


def seen(truth: Recording, effect: str, value: float, side: int) -> Recording:
    """Return what is recorded where one pressure sensor has a fault."""
    column = f"piston.pressure_{side}"
    true = truth[column]
    false = {
        "sensor_delay": np.interp(truth.time - value, truth.time, true),
        "sensor_scale": value * true,
        "sensor_bias": true + value,
    }[effect]
    return replace(truth, columns={**truth.columns, column: false})


def force_error(one: MotionRun, other: MotionRun) -> float:
    return float(np.abs(one.drive - other.drive)[INSIDE].max())


@pytest.mark.parametrize("side", [1, 2])
@pytest.mark.parametrize(
    ("effect", "value"), [("sensor_delay", 0.008), ("sensor_delay", -0.005), ("sensor_scale", 1.06), ("sensor_bias", 6e3)]
)
def test_the_drive_is_what_it_truly_was(rig: Rig, truth: Recording, effect: str, value: float, side: int) -> None:
    (exact,) = case_of(rig, truth).joints["slide"]
    case = case_of(rig, seen(truth, effect, value, side))
    (raw,) = case.joints["slide"]
    (mended,) = carried_over(case, [judged(case, effect, value, side)], PARTS)["slide"]
    assert force_error(raw, exact) > 3.0
    assert force_error(mended, exact) < 0.01 * force_error(raw, exact)
    np.testing.assert_allclose(mended.gauge[INSIDE], exact.gauge[INSIDE], atol=0.01 * np.abs(raw.gauge - exact.gauge).max())
    assert case.joints["slide"][0] is raw  # what was handed in stays


@pytest.mark.parametrize("seconds", [0.004, -0.003])
def test_forces_come_as_late_as_the_position_does(rig: Rig, truth: Recording, seconds: float) -> None:
    late = np.interp(truth.time - seconds, truth.time, truth["slide.position"])
    (exact,) = case_of(rig, truth).joints["slide"]
    case = case_of(rig, replace(truth, columns={**truth.columns, "slide.position": late}))
    (raw,) = case.joints["slide"]
    gas = judged(case, "sensor_delay", seconds, position=True)
    (mended,) = carried_over(case, [gas], PARTS)["slide"]
    then = np.interp(exact.time - seconds, exact.time, exact.drive)
    assert np.abs(raw.drive - then)[INSIDE].max() > 1.0
    assert np.abs(mended.drive - then)[INSIDE].max() < 0.02 * np.abs(raw.drive - then)[INSIDE].max()
    np.testing.assert_array_equal(mended.inertial, raw.inertial)


def test_missing_samples_do_not_spread(rig: Rig, truth: Recording) -> None:
    table = seen(truth, "sensor_delay", 0.008, 1)
    table.columns["piston.pressure_1"][700:708] = np.nan
    (exact,) = case_of(rig, truth).joints["slide"]
    case = case_of(rig, table)
    (mended,) = carried_over(case, [judged(case, "sensor_delay", 0.008)], PARTS)["slide"]
    assert np.isfinite(mended.drive).all()
    assert force_error(mended, exact) < 0.02 * force_error(case.joints["slide"][0], exact)


@pytest.mark.parametrize("why", ["nothing judged", "nothing named", "no name", "hardly a fault"])
def test_without_a_fault_nothing_changes(rig: Rig, truth: Recording, why: str) -> None:
    case = case_of(rig, truth)
    gas = {
        "nothing judged": [],
        "nothing named": [judged(case, "sensor_scale", 1.06, named=())],
        "no name": [judged(case, "sensor_scale", 1.06, nameless=True)],
        "hardly a fault": [judged(case, "sensor_bias", 0.9 * LEAST)],
    }[why]
    after = carried_over(case, gas, PARTS)
    assert after.keys() == case.joints.keys()
    assert all(one is other for joint in after for one, other in zip(after[joint], case.joints[joint], strict=True))


def test_a_load_cell_needs_no_correction(rig: Rig, truth: Recording) -> None:
    """Where the drive is a load cell's, a pressure sensor's fault has no part in it."""
    force = 50.0 * np.sin(4.0 * truth.time)
    table = replace(truth, columns={**truth.columns, "piston.force": force}, units={**truth.units, "piston.force": "N"})
    case = case_of(rig, seen(table, "sensor_scale", 1.06, 1))
    (raw,) = case.joints["slide"]
    (after,) = carried_over(case, [judged(case, "sensor_scale", 1.06)], PARTS)["slide"]
    assert after is raw


def test_the_balance_along_a_rod_is_mended_too(rig: Rig, truth: Recording) -> None:
    force = 50.0 * np.sin(4.0 * truth.time)
    table = replace(truth, columns={**truth.columns, "piston.force": force}, units={**truth.units, "piston.force": "N"})
    exact = rod_run(case_of(rig, table).cylinders["piston"][0], rig)
    case = case_of(rig, seen(table, "sensor_delay", 0.008, 2))
    raw = rod_run(case.cylinders["piston"][0], rig)
    assert exact is not None and raw is not None
    case.joints = {"piston": [raw]}
    (mended,) = carried_over(case, [judged(case, "sensor_delay", 0.008, 2)], PARTS)["piston"]
    assert force_error(raw, exact) > 3.0
    assert force_error(mended, exact) < 0.01 * force_error(raw, exact)
    np.testing.assert_array_equal(mended.inertial, raw.inertial)
