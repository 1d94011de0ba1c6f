"""A sensor's fault that the gas gave away is taken off the forces: the drive is then what it truly was."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import benches
import mujoco
import numpy as np
import pytest

from exo_sim.diagnosis.coupling.corrected_pressures import _external_power, corrected_balances, with_corrected_pressures
from exo_sim.diagnosis.data.cylinder_run import cylinder_runs
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.policy.recordings import CORRECTED_PRESSURE
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.candidates import candidates
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.motion.load_cell import rod_run
from exo_sim.diagnosis.subsystems.motion.motion_runs import motion_runs
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
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


def case_of(rig: Rig, table: Recording) -> MachineData:
    model: mujoco.MjModel = load(rig)
    links = linkages(rig, model)
    joints = {"slide": tuple(motion_runs(table, rig, model, links)[0])}
    return MachineData(rig, model, links, (table,), (table,), {"piston": tuple(cylinder_runs(table, rig, model, links))}, joints)


def judged(
    case: MachineData, effect: str, value: float, side: int = 1, position: bool = False, **more: Any
) -> SubsystemResult[GasModel]:
    """Return what the gas says once a sensor's fault has been found in it."""
    plant = PlantParameters(assembly.world(case.rig), assembly.cylinders(case.rig))
    model = GasModel(case.cylinders["piston"], plant, PARTS)
    column = "slide.position" if position else f"piston.pressure_{side}"
    asked = candidates(plant, case.cylinders["piston"], "piston", "slide")
    named: Candidate = next(c for c in asked if c.at == (effect, column))
    fit = Fit(named.parameters, {named.parameters[0]: value}, np.zeros(model.size), np.zeros((model.size, 1)))
    final = FittedModel((named,), fit)
    fields: dict[str, Any] = {"named": (named,), **more}
    return SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final, **fields)


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
    return float(np.abs(one.drive.force - other.drive.force)[INSIDE].max())


@pytest.mark.parametrize("side", [1, 2])
@pytest.mark.parametrize(
    ("effect", "value"), [("sensor_delay", 0.008), ("sensor_delay", -0.005), ("sensor_scale", 1.06), ("sensor_bias", 6e3)]
)
def test_the_drive_is_what_it_truly_was(rig: Rig, truth: Recording, effect: str, value: float, side: int) -> None:
    (exact,) = case_of(rig, truth).joints["slide"]
    case = case_of(rig, seen(truth, effect, value, side))
    (raw,) = case.joints["slide"]
    (mended,) = corrected_balances(case, [judged(case, effect, value, side)], PARTS)["slide"]
    assert force_error(raw, exact) > 3.0
    assert force_error(mended, exact) < 0.01 * force_error(raw, exact)
    tolerance = 0.01 * np.abs(raw.drive.gauge - exact.drive.gauge).max()
    np.testing.assert_allclose(mended.drive.gauge[INSIDE], exact.drive.gauge[INSIDE], atol=tolerance)
    assert case.joints["slide"][0] is raw  # what was handed in stays


@pytest.mark.parametrize(("effect", "value"), [("sensor_scale", 1.06), ("sensor_bias", 6e3)])
def test_behind_a_hose_a_fault_of_the_sensor_is_taken_off_once(tmp_path: Path, effect: str, value: float) -> None:
    hose = '[effects.line_restriction.piston]\narea = "1 mm^2"\nvolume = "5 cm^3"\nsensor = "valve"\n'
    rig = benches.bench(tmp_path, hose)
    truth = benches.led(rig, 1.5)
    sound, faulty = case_of(rig, truth), case_of(rig, seen(truth, effect, value, 1))
    (exact,) = corrected_balances(sound, [judged(sound, effect, value, named=())], PARTS)["slide"]
    (raw,) = faulty.joints["slide"]
    (mended,) = corrected_balances(faulty, [judged(faulty, effect, value)], PARTS)["slide"]
    assert force_error(mended, exact) < 0.05 * force_error(raw, case_of(rig, truth).joints["slide"][0])


@pytest.mark.parametrize(("unknown", "area", "is_open"), [(True, 0.03, True), (False, 0.03, False), (True, 60.0, False)])
def test_a_balance_is_left_open_whose_pressures_lie_behind_a_hose_that_nobody_understands(
    tmp_path: Path, unknown: bool, area: float, is_open: bool
) -> None:
    """Unless the hose is so wide that it changes nothing."""
    rig = benches.bench(tmp_path, f'[effects.line_restriction.piston]\narea = "{area} mm^2"\nvolume = "5 cm^3"\nsensor = "valve"\n')
    case = case_of(rig, benches.led(rig, 1.5))
    after = with_corrected_pressures(case, [judged(case, "sensor_scale", 1.0, named=(), has_unknown=unknown)], PARTS)
    left = [one for one in after.open_questions if "behind hoses" in one.why]
    assert len(left) == (1 if is_open else 0)
    assert all("slide" in one.question and "at the cylinder" in one.do for one in left)
    assert not is_open or "slide" not in after.joints


@pytest.mark.parametrize(("value", "taken_off"), [(9e3, True), (1e3, False)])
def test_a_zero_that_was_only_refitted_is_taken_off_where_no_healthy_sensor_has_it(
    rig: Rig, truth: Recording, value: float, taken_off: bool
) -> None:
    """Left in the forces, it is friction that differs by direction."""
    (exact,) = case_of(rig, truth).joints["slide"]
    case = case_of(rig, seen(truth, "sensor_bias", value, 2))
    (raw,) = case.joints["slide"]
    zero = FreeParameter("sensor_zero", "piston.pressure_2", "pressure_2.bias", "Pa", Target.SENSOR, 500.0, -1e4, 1e4, (0.0, 500.0))
    gas = judged(case, "sensor_bias", value, 2, named=(), refitted=((zero, 50.0),))
    final = FittedModel((), Fit((zero,), {zero: value}, np.zeros(gas.model.size), np.zeros((gas.model.size, 1))))
    (mended,) = corrected_balances(case, [replace(gas, final=final)], PARTS)["slide"]
    assert (mended is not raw) is taken_off
    if taken_off:
        assert force_error(mended, exact) < 0.01 * force_error(raw, exact)


@pytest.mark.parametrize("seconds", [0.004, -0.003])
def test_forces_come_as_late_as_the_position_does(rig: Rig, truth: Recording, seconds: float) -> None:
    late = np.interp(truth.time - seconds, truth.time, truth["slide.position"])
    (exact,) = case_of(rig, truth).joints["slide"]
    case = case_of(rig, replace(truth, columns={**truth.columns, "slide.position": late}))
    (raw,) = case.joints["slide"]
    gas = judged(case, "sensor_delay", seconds, position=True)
    (mended,) = corrected_balances(case, [gas], PARTS)["slide"]
    then = np.interp(exact.time - seconds, exact.time, exact.drive.force)
    assert np.abs(raw.drive.force - then)[INSIDE].max() > 1.0
    assert np.abs(mended.drive.force - then)[INSIDE].max() < 0.02 * np.abs(raw.drive.force - then)[INSIDE].max()
    np.testing.assert_array_equal(mended.inertia.force, raw.inertia.force)


def test_missing_samples_do_not_spread(rig: Rig, truth: Recording) -> None:
    table = seen(truth, "sensor_delay", 0.008, 1)
    table.columns["piston.pressure_1"][700:708] = np.nan
    (exact,) = case_of(rig, truth).joints["slide"]
    case = case_of(rig, table)
    (mended,) = corrected_balances(case, [judged(case, "sensor_delay", 0.008)], PARTS)["slide"]
    assert np.isfinite(mended.drive.force).all()
    assert force_error(mended, exact) < 0.02 * force_error(case.joints["slide"][0], exact)


def test_what_pushes_where_forces_are_not_known_is_no_drive(rig: Rig, truth: Recording) -> None:
    """A stop, or a hole of the pressures: what is missing there is nobody's push."""
    case = case_of(rig, truth)
    (run,) = case.joints["slide"]
    there = np.ones(len(run.time), dtype=bool)
    there[1100:] = False
    speed = run.kinematics.velocity / run.drive.divisor
    known = replace(run, drive=replace(run.drive, force=run.demand - 20.0 * np.sign(speed) * ~there))
    assert _external_power(known) != ""
    assert _external_power(replace(known, known=there)) == ""


@pytest.mark.parametrize("why", ["nothing judged", "nothing named", "no name", "hardly a fault"])
def test_without_a_fault_nothing_changes(rig: Rig, truth: Recording, why: str) -> None:
    case = case_of(rig, truth)
    gas = {
        "nothing judged": [],
        "nothing named": [judged(case, "sensor_scale", 1.06, named=())],
        "no name": [judged(case, "sensor_scale", 1.06, has_unknown=True)],
        "hardly a fault": [judged(case, "sensor_bias", 0.9 * CORRECTED_PRESSURE)],
    }[why]
    after = corrected_balances(case, gas, PARTS)
    assert after.keys() == case.joints.keys()
    assert all(one is other for joint in after for one, other in zip(after[joint], case.joints[joint], strict=True))


def test_a_load_cell_needs_no_correction(rig: Rig, truth: Recording) -> None:
    """Where the drive is a load cell's, a pressure sensor's fault has no part in it."""
    force = 50.0 * np.sin(4.0 * truth.time)
    table = replace(truth, columns={**truth.columns, "piston.force": force}, units={**truth.units, "piston.force": "N"})
    case = case_of(rig, seen(table, "sensor_scale", 1.06, 1))
    (raw,) = case.joints["slide"]
    (after,) = corrected_balances(case, [judged(case, "sensor_scale", 1.06)], PARTS)["slide"]
    assert after is raw


def test_the_balance_along_a_rod_is_mended_too(rig: Rig, truth: Recording) -> None:
    force = 50.0 * np.sin(4.0 * truth.time)
    table = replace(truth, columns={**truth.columns, "piston.force": force}, units={**truth.units, "piston.force": "N"})
    exact = rod_run(case_of(rig, table).cylinders["piston"][0], rig)
    case = case_of(rig, seen(table, "sensor_delay", 0.008, 2))
    raw = rod_run(case.cylinders["piston"][0], rig)
    assert exact is not None and raw is not None
    case = replace(case, joints={"piston": (raw,)})
    (mended,) = corrected_balances(case, [judged(case, "sensor_delay", 0.008, 2)], PARTS)["piston"]
    assert force_error(raw, exact) > 3.0
    assert force_error(mended, exact) < 0.01 * force_error(raw, exact)
    np.testing.assert_array_equal(mended.inertia.force, raw.inertia.force)
