"""The improved rig: what was found is in it, what only a fit moved is in it with a note, and it reads back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest
from diagnosis import motion_runs, waves

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.outcome.rig_update import Part, Rank, RigUpdate, rig_update
from exo_sim.diagnosis.pipeline.motion_stage import nominal_balance
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nuisance_calibration import Deviation
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import UnknownEffect
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.motion.candidates import candidates
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.rig import Correction, EffectEntry, EffectSetting, Rig, parse

AREA = FreeParameter("piston_leakage", "piston", "area", "m^2", Target.CYLINDER, 1e-8, 0.0, 1e-6)
LEAK = Candidate("piston_leakage", "piston", "area", (AREA,), ((1e-8,),))
VALVE = FreeParameter("flow_capacity", "piston", "valve_area", "1", Target.FACTOR, 0.1, 0.05, 10.0, (1.0, 0.1), neutral=1.0)
ZERO = FreeParameter("sensor_zero", "piston.pressure_1", "pressure_1.bias", "Pa", Target.SENSOR, 500.0, -1e4, 1e4, (0.0, 500.0))

CARD = FreeParameter("card_delay", "piston", "position.delay", "s", Target.SENSOR, 1e-3, -4e-3, 4e-3, (0.0, 1e-3))


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> MachineData:
    rig = benches.bench(tmp_path_factory.mktemp("update"))
    model = load(rig)
    return MachineData(rig, model, linkages(rig, model), (), (), {}, {})


class GasWaves(waves.Waves):
    """Waves whose columns are as late as those of a gas."""

    late_columns = GasModel.late_columns  # type: ignore[assignment]


def result(values: dict[FreeParameter, float], *named: Candidate) -> SubsystemResult[waves.Waves]:
    model = GasWaves()
    final = FittedModel(named, Fit(tuple(values), values, np.zeros(4), np.zeros((4, len(values)))))
    return SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final, named)


def read_back(update: RigUpdate, data: MachineData) -> Rig:
    return parse(update.text(Path(data.rig.path).parent), data.rig.path)


def test_a_finding_is_switched_on_with_its_number(data: MachineData) -> None:
    finding = Finding("piston_leakage", "piston", Kind.MISSING_PHYSICS, "", {"area": Estimate(3e-8, "m^2", 2e-8, 4e-8)}, 9.0, 0.5)
    one = replace(result({AREA: 3e-8}, LEAK), findings=(finding,))
    effect = read_back(rig_update(data, [one], ()), data).effect("piston_leakage", "piston")
    assert effect is not None and effect.parameters["area"] == pytest.approx(3e-8)


@pytest.mark.parametrize("at_joint", [0.0, 4.0])
def test_friction_of_two_directions_replaces_what_the_rig_says_of_its_piston(tmp_path: Path, at_joint: float) -> None:
    """What it says of the joint stays there and is part of what was found."""
    said = '[effects.coulomb_friction.piston]\nforce = "20 N"\n' + f'[effects.coulomb_friction.slide]\nforce = "{at_joint} N"\n'
    rig = benches.bench(tmp_path, said)
    model = load(rig)
    data = MachineData(rig, model, linkages(rig, model), (), (), {}, {})
    run = motion_runs.behind_cylinder(motion_runs.balance(np.zeros(motion_runs.TIME.size)), np.zeros((motion_runs.TIME.size, 2)))
    balance = MotionModel([run], nominal_balance(data, "slide", [run]), Split({}))
    (apart,) = (c for c in candidates(balance.runs, balance.nominal, "piston") if c.effect == "asymmetric_friction")
    values = dict(zip(apart.parameters, (20.0, 28.0), strict=True))
    final = FittedModel((apart,), Fit(tuple(values), values, np.zeros(4), np.zeros((4, 2))))
    whole = {q.parameter: Estimate(value, "N", value - 1.0, value + 1.0) for q, value in values.items()}
    finding = Finding("asymmetric_friction", "piston", Kind.MISSING_PHYSICS, "", whole, 9.0, 0.5)
    one = SubsystemResult("slide", balance, ModelFits(balance, ()), SearchResult(final, final), final, (apart,), findings=(finding,))
    again = read_back(rig_update(data, [one], ()), data)
    assert again.effect("coulomb_friction", "piston") is None and again.effect("coulomb_friction", "slide") is not None
    written = again.effect("asymmetric_friction", "piston")
    assert written is not None and written.parameters == pytest.approx({"forward": 20.0 - at_joint, "backward": 28.0 - at_joint})


def test_what_was_found_of_a_joint_with_the_name_of_a_cylinder_is_not_written_as_the_cylinders(tmp_path: Path) -> None:
    """With a load cell the balance is of the joint alone, and a rig file has no place for it."""
    said = '[effects.viscous_friction.piston]\ncoefficient = "20 N s/m"\n'
    rig = benches.renamed(benches.bench(tmp_path, said), "piston", "slide")
    model = load(rig)
    data = MachineData(rig, model, linkages(rig, model), (), (), {}, {})
    run = motion_runs.balance(np.zeros(motion_runs.TIME.size), turning=True)
    balance = MotionModel([run], nominal_balance(data, "slide", [run]), Split({}))
    viscous = next(c for c in candidates(balance.runs, balance.nominal, "slide") if c.effect == "viscous_friction")
    size = viscous.parameters[0]
    final = FittedModel((viscous,), Fit((size,), {size: 5.0}, np.zeros(4), np.zeros((4, 1))))
    estimates = {size.parameter: Estimate(5.0, size.unit, 4.0, 6.0)}
    finding = Finding("viscous_friction", "slide", Kind.MISSING_PHYSICS, "", estimates, 9.0, 0.5)
    one = SubsystemResult("slide", balance, ModelFits(balance, ()), SearchResult(final, final), final, (viscous,), findings=(finding,))
    update = rig_update(data, [one], ())
    assert size.unit == "N*m*s/rad" and update.parts == ()
    assert [entry.setting.name for entry in update.unsayable] == ["viscous_friction"]
    unnamed = replace(data, rig=benches.bench(tmp_path))
    assert rig_update(unnamed, [one], ()).unsayable == ()
    assert [part.rank for part in rig_update(unnamed, [one], ()).parts] == [Rank.FOUND]


def test_a_finding_that_was_taken_back_is_not(data: MachineData) -> None:
    assert rig_update(data, [result({AREA: 3e-8}, LEAK)], ()).entries == ()


def test_a_deviation_corrects_the_believed_number(data: MachineData) -> None:
    one = replace(result({VALVE: 1.25}), deviations=(Deviation(VALVE, 1.25, 0.01),))
    update = rig_update(data, [one], ())
    believed = data.rig.cylinders["piston"].valve_area
    assert read_back(update, data).cylinders["piston"].valve_area == pytest.approx(1.25 * believed, rel=1e-6)
    (correction,) = update.corrections
    assert correction.interval is not None and correction.interval[0] < 1.25 * believed < correction.interval[1]


def test_what_was_only_refitted_says_so_and_a_zero_becomes_a_bias(data: MachineData) -> None:
    update = rig_update(data, [replace(result({VALVE: 1.02, ZERO: 800.0}), refitted=((VALVE, 0.01), (ZERO, 50.0)))], ())
    (correction,) = update.corrections
    assert correction.interval is not None and "no finding" in correction.note
    rig = read_back(update, data)
    bias = rig.effect("sensor_bias", "piston.pressure_1")
    assert bias is not None and bias.parameters["value"] == pytest.approx(800.0)


@pytest.mark.parametrize(("value", "healthy"), [(800.0, True), (8000.0, False)])
def test_a_zero_that_no_healthy_sensor_has_is_not_called_one(data: MachineData, value: float, healthy: bool) -> None:
    update = rig_update(data, [replace(result({ZERO: value}), refitted=((ZERO, 50.0),))], ())
    (entry,) = update.entries
    assert entry.says.startswith("No finding") is healthy


def test_the_curve_of_an_unknown_effect_is_one_that_the_simulator_follows(data: MachineData) -> None:
    at = np.linspace(0.0, 0.2, 13)
    curve = Curve("position", at, np.sin(at), 0.1 * at, 0.9)
    missing = Discrepancy("force", "N", "force balance", (curve,), 1.0)
    finding = Finding("unknown", "piston", Kind.UNKNOWN, "Something acts.", {}, 9.0, 0.5)
    update = rig_update(data, [], [UnknownEffect(finding, missing, result({}))])
    effect = read_back(update, data).effect("unknown", "piston")
    assert effect is not None and effect.curves["values"] == pytest.approx(tuple(np.sin(at)), rel=1e-5)
    assert rig_update(data, [], [UnknownEffect(finding, missing, result({}), is_told_apart=False)]).entries == ()
    beyond = replace(missing, curves=(replace(curve, variable="time"),))
    assert rig_update(data, [], [UnknownEffect(finding, beyond, result({}))]).entries == ()


@pytest.mark.parametrize(("fitted", "late"), [(-3e-3, ("piston.pressure_1", "piston.pressure_2")), (2e-3, ("slide.position",))])
def test_a_card_that_was_fitted_as_late_is_late_in_the_rig_and_no_sensor_is_early(
    data: MachineData, fitted: float, late: tuple[str, ...]
) -> None:
    rig = read_back(rig_update(data, [replace(result({CARD: fitted}), refitted=((CARD, 1e-4),))], ()), data)
    delays = {setting.where: setting.parameters["seconds"] for setting in rig.effects if setting.name == "sensor_delay"}
    assert delays == pytest.approx(dict.fromkeys(late, abs(fitted)))


def test_a_late_card_that_is_no_finding_stays_in_the_rig(data: MachineData) -> None:
    card = FreeParameter("sensor_delay", "piston.pressure_1", "pressures.delay", "s", Target.SENSOR, 2e-3, -4e-3, 0.05)
    one = replace(result({card: 5e-3, CARD: -1e-3}), refitted=((card, 1e-4), (CARD, 1e-4)))
    rig = read_back(rig_update(data, [one], ()), data)
    for side in (1, 2):
        effect = rig.effect("sensor_delay", f"piston.pressure_{side}")
        assert effect is not None and effect.parameters["seconds"] == pytest.approx(6e-3)


def test_forces_say_how_late_a_sensor_is_where_no_gas_was_judged(data: MachineData) -> None:
    balance = MotionModel([motion_runs.balance(np.zeros(motion_runs.TIME.size), 0.1)], motion_runs.plant(), Split({}))
    delay = FreeParameter("drive_delay", balance.runs[0].joint, "drive.delay", "s", Target.SENSOR, 1e-3, -0.01, 0.01, (0.0, 1e-3))
    final = FittedModel((), Fit((delay,), {delay: -2e-3}, np.zeros(4), np.zeros((4, 1))))
    late = SubsystemResult(
        "slide", balance, ModelFits(balance, ()), SearchResult(final, final), final, refitted=((delay, 1e-4),)
    )
    rig = read_back(rig_update(data, [late], ()), data)
    effect = rig.effect("sensor_delay", f"{balance.runs[0].joint}.position")
    assert effect is not None and effect.parameters["seconds"] == pytest.approx(2e-3)


@pytest.mark.parametrize(("name", "written"), [("sensor_scale", True), ("sensor_bias", False)])
def test_beside_a_judged_gas_forces_say_the_scale_of_a_pressure_but_not_its_zero(data: MachineData, name: str, written: bool) -> None:
    """A gas hardly shows by how much a reading is too large: that much more is supplied."""
    column, parameter, value = "piston.pressure_2", "factor" if name == "sensor_scale" else "value", 1.025

    class Forces(waves.Waves):
        def as_sensor_error(self, refitted: FreeParameter, fitted: float) -> tuple[str, str, str, float] | None:
            return column, name, parameter, fitted

    class Gas(GasWaves):
        calibrates_pressures = True

    error = FreeParameter("gain", column, "scale", "1", Target.SENSOR, 0.01, 0.5, 2.0, (1.0, 0.01), neutral=1.0)
    forces = replace(result({error: value}), model=Forces(), refitted=((error, 1e-3),))
    gas = replace(result({}), model=Gas())
    effect = read_back(rig_update(data, [gas, forces], ()), data).effect(name, column)
    assert (effect is not None) == written
    if effect is not None:
        assert effect.parameters[parameter] == pytest.approx(value)


def test_what_was_refitted_of_sensors_and_of_the_machine_stand_without_each_other(data: MachineData) -> None:
    update = rig_update(data, [replace(result({VALVE: 1.02, ZERO: 800.0}), refitted=((VALVE, 0.01), (ZERO, 50.0)))], ())
    sensors, machine = update.reduced()
    assert machine.entries == () and len(machine.corrections) == 1
    assert sensors.corrections == () and [entry.setting.name for entry in sensors.entries] == ["sensor_bias"]


def test_what_another_update_leaves_out_is_said_in_words(data: MachineData) -> None:
    setting = EffectSetting("coulomb_friction", "piston", {"force": 9.0}, False)
    whole = RigUpdate(
        data.rig,
        (
            Part("gas of piston", Rank.REFITTED, (), (Correction(("cylinders", "piston", "dead_volume_1"), 2e-5, "m^3"),)),
            Part("motion of slide", Rank.FOUND, (EffectEntry(setting, {}, ""),), (Correction(("bodies", "load", "mass"), 3.0, "kg"),)),
        ),
    )
    assert whole.without(whole) == ""
    assert whole.without(replace(whole, parts=whole.parts[1:])) == "numbers that were refitted and are no finding (gas of piston)"
    assert whole.without(replace(whole, parts=whole.parts[:1])) == "Coulomb friction, mass (motion of slide)"


def test_a_number_that_the_rig_leaves_out_of_an_effect_that_it_has_is_written_beside_the_others(tmp_path: Path) -> None:
    """A dead time beside a lag: without it the refitted lag is half of what was fitted, and a whole machine is worse than before."""
    rig = benches.bench(tmp_path, '[effects.valve_lag.piston]\ntime_constant = "2.6 ms"\n')
    model = load(rig)
    slow = MachineData(rig, model, linkages(rig, model), (), (), {}, {})
    lag = FreeParameter("valve_lag", "piston", "time_constant", "s", Target.CYLINDER, 1e-3, 0.0, 0.1, (2.6e-3, 1e-3))
    delay = FreeParameter("valve_lag", "piston", "delay", "s", Target.CYLINDER, 1e-3, 0.0, 3e-3, (0.0, 1e-3))
    one = replace(result({lag: 1.25e-3, delay: 1.4e-3}), refitted=((lag, 1e-4), (delay, 1e-4)))
    effect = read_back(rig_update(slow, [one], ()), slow).effect("valve_lag", "piston")
    assert effect is not None and effect.parameters == pytest.approx({"time_constant": 1.25e-3, "delay": 1.4e-3})
    nothing = replace(result({lag: 1.25e-3, delay: 0.0}), refitted=((lag, 1e-4), (delay, 1e-4)))
    effect = read_back(rig_update(slow, [nothing], ()), slow).effect("valve_lag", "piston")
    assert effect is not None and effect.parameters == pytest.approx({"time_constant": 1.25e-3})
    excess = FreeParameter("valve_lag", "piston", "closing_excess", "1", Target.CYLINDER, 0.5, -0.9, 9.0)  # a law has no prior
    uneven = replace(result({lag: 2.5e-3, excess: 0.6}), refitted=((lag, 1e-4), (excess, 0.05)))
    effect = read_back(rig_update(slow, [uneven], ()), slow).effect("valve_lag", "piston")
    assert effect is not None and effect.parameters["closing_excess"] == pytest.approx(0.6)


def test_a_law_of_a_healthy_machine_stays_in_the_rig_whatever_its_prior_holds_to_be_usual(data: MachineData) -> None:
    """Heat of a finding was fitted with all of the wall that it touches: without that the rig has another heat than was fitted."""
    heat = FreeParameter("wall_heat_transfer", "piston", "conductance", "W/K", Target.CYLINDER, 0.2, 0.0, 20.0)
    exposure, exponent, stirring = (
        FreeParameter("heat_transfer_law", "piston", name, "1", Target.CYLINDER, 0.5, 0.0, 1.0, prior)
        for name, prior in (("exposure", (0.5, 0.5)), ("exponent", (0.25, 0.25)), ("stirring", (0.0, 0.5)))
    )
    wall = Candidate("wall_heat_transfer", "piston", "conductance", (heat,), ((0.2,),))
    reported = Finding("wall_heat_transfer", "piston", Kind.MISSING_PHYSICS, "Heat.", {}, 1.0, 0.0)
    numbers = {exposure: 0.96, exponent: 0.4, stirring: 0.14}
    law = tuple((q, 0.1) for q in numbers)
    found = replace(result({heat: 0.27, **numbers}, wall), findings=(reported,), refitted=law)
    rig = read_back(rig_update(data, [found], ()), data)
    said = {q.parameter: value for q, value in numbers.items()}
    for name, values in (("wall_heat_transfer", {"conductance": 0.27}), ("heat_transfer_law", said)):
        effect = rig.effect(name, "piston")
        assert effect is not None and effect.parameters == pytest.approx(values)
    healthy = replace(result({heat: 0.02, **numbers}), refitted=((heat, 0.01), *law))  # no finding: the wall of any machine, and its law
    effect = read_back(rig_update(data, [healthy], ()), data).effect("wall_heat_transfer", "piston")
    assert effect is not None and effect.parameters == pytest.approx({"conductance": 0.02})


def test_numbers_that_a_law_asks_anew_take_the_place_of_the_rig_s_though_they_are_nil(tmp_path: Path) -> None:
    """A spool of second order is late by the whole of what a dead time and a first order were: were the dead time kept, by twice that."""
    rig = benches.bench(tmp_path, '[effects.valve_lag.piston]\ntime_constant = "4 ms"\ndelay = "5 ms"\n')
    model = load(rig)
    slow = MachineData(rig, model, linkages(rig, model), (), (), {}, {})
    known = {
        FreeParameter("valve_lag", "piston", name, "s", Target.CYLINDER, 1e-3, 0.0, 0.1, (value, 1e-3)): value
        for name, value in (("time_constant", 4e-3), ("delay", 5e-3))
    }
    anew = {
        FreeParameter("valve_lag", "piston", name, unit, Target.CYLINDER, 1e-3, 0.0, 25.0): value
        for name, unit, value in (("time_constant", "s", 9e-3), ("delay", "s", 0.0), ("inertia", "1", 0.5))
    }
    found = replace(result({**known, **anew}), refitted=tuple((q, 1e-4) for q in (*known, *anew)))
    effect = read_back(rig_update(slow, [found], ()), slow).effect("valve_lag", "piston")
    assert effect is not None
    assert {"delay": 0.0, **effect.parameters} == pytest.approx({"time_constant": 9e-3, "delay": 0.0, "inertia": 0.5})


def test_a_rig_with_numbers_that_are_no_finding_says_once_what_to_do_with_them(data: MachineData) -> None:
    folder = Path(data.rig.path).parent
    late = EffectEntry(EffectSetting("sensor_delay", "piston.pressure_1", {"seconds": 7e-6}), {}, "No finding.")
    refitted, found = RigUpdate(data.rig, (Part("a", Rank.SENSORS, (late,)),)), RigUpdate(data.rig, (Part("a", Rank.FOUND, (late,)),))
    text = refitted.text(folder)
    assert text.startswith('# Numbers marked "no finding"') and "They can stay" in text
    assert not found.text(folder).startswith("#")
    again = replace(refitted, rig=parse(text, data.rig.path))
    assert again.text(folder).count("They can stay") == 1


def test_what_a_healthy_machine_shows_is_left_out_where_a_finding_says_as_much(data: MachineData) -> None:
    """Dry friction of two directions and dry friction exclude each other in a rig; the second is a joint's, as a healthy one's."""
    dry = FreeParameter("coulomb_friction", "piston", "force", "N", Target.CYLINDER, 1.0, 0.0, 50.0, (0.0, 2.0))
    forward, backward = (
        FreeParameter("asymmetric_friction", "piston", way, "N", Target.CYLINDER, 1.0, 0.0, 50.0) for way in ("forward", "backward")
    )
    two = Candidate("asymmetric_friction", "piston", "force", (forward, backward), ((5.0, 5.0),))
    reported = Finding("asymmetric_friction", "piston", Kind.MISSING_PHYSICS, "Dry.", {}, 1.0, 0.0)
    rod = replace(result({forward: 6.0, backward: 7.0}, two), findings=(reported,))
    joint = replace(result({dry: 1.5}), refitted=((dry, 0.5),))
    alone = rig_update(data, [joint], ())
    assert [entry.setting.name for entry in alone.entries] == ["coulomb_friction"]
    both = rig_update(data, [rod, joint], ())
    assert [entry.setting.name for entry in both.entries] == ["asymmetric_friction"]
    read_back(both, data)
