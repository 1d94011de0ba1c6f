"""The improved rig: what was found is in it, what only a fit moved is in it with a note, and it reads back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.outcome.rig_update import RigUpdate, rig_update
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nuisance_calibration import Deviation
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import UnknownEffect
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.rig import Rig, parse

AREA = FreeParameter("piston_leakage", "piston", "area", "m^2", Target.CYLINDER, 1e-8, 0.0, 1e-6)
LEAK = Candidate("piston_leakage", "piston", "area", (AREA,), ((1e-8,),))
VALVE = FreeParameter("flow_capacity", "piston", "valve_area", "1", Target.FACTOR, 0.1, 0.05, 10.0, (1.0, 0.1), neutral=1.0)
ZERO = FreeParameter("sensor_zero", "piston.pressure_1", "pressure_1.bias", "Pa", Target.SENSOR, 500.0, -1e4, 1e4, (0.0, 500.0))


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> MachineData:
    rig = benches.bench(tmp_path_factory.mktemp("update"))
    model = load(rig)
    return MachineData(rig, model, linkages(rig, model), (), (), {}, {})


def result(values: dict[FreeParameter, float], *named: Candidate) -> SubsystemResult[waves.Waves]:
    model = waves.Waves()
    final = FittedModel(named, Fit(tuple(values), values, np.zeros(4), np.zeros((4, len(values)))))
    return SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final, named)


def read_back(update: RigUpdate, data: MachineData) -> Rig:
    return parse(update.text(Path(data.rig.path).parent), data.rig.path)


def test_a_finding_is_switched_on_with_its_number(data: MachineData) -> None:
    finding = Finding("piston_leakage", "piston", Kind.MISSING_PHYSICS, "", {"area": Estimate(3e-8, "m^2", 2e-8, 4e-8)}, 9.0, 0.5)
    one = replace(result({AREA: 3e-8}, LEAK), findings=(finding,))
    effect = read_back(rig_update(data, [one], ()), data).effect("piston_leakage", "piston")
    assert effect is not None and effect.parameters["area"] == pytest.approx(3e-8)


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
    assert correction.interval is None and "no finding" in correction.note
    rig = read_back(update, data)
    bias = rig.effect("sensor_bias", "piston.pressure_1")
    assert bias is not None and bias.parameters["value"] == pytest.approx(800.0)


def test_the_curve_of_an_unknown_effect_is_one_that_the_simulator_follows(data: MachineData) -> None:
    at = np.linspace(0.0, 0.2, 13)
    curve = Curve("position", at, np.sin(at), 0.1 * at, 0.9)
    missing = Discrepancy("force", "N", "force balance", (curve,), 1.0)
    finding = Finding("unknown", "piston", Kind.UNKNOWN, "Something acts.", {}, 9.0, 0.5)
    update = rig_update(data, [], [UnknownEffect(finding, missing, result({}))])
    effect = read_back(update, data).effect("unknown", "piston")
    assert effect is not None and effect.curves["values"] == pytest.approx(tuple(np.sin(at)), rel=1e-5)
    beyond = replace(missing, curves=(replace(curve, variable="time"),))
    assert rig_update(data, [], [UnknownEffect(finding, beyond, result({}))]).entries == ()
