"""Sensors that are all off by one gain beside a supply that was recorded: the supply's sensor is off, and no other is accused."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.data.cylinder_run import cylinder_runs
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.budget import Budget
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.estimation.threads import SERIAL
from exo_sim.diagnosis.findings import Estimate, Finding, Kind, Subsystem
from exo_sim.diagnosis.pipeline import shared_supply
from exo_sim.diagnosis.pipeline.plan import Examination, Plan, Results
from exo_sim.diagnosis.pipeline.shared_supply import put_right, shared_gains, with_supply_put_right
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.validation.held_out_errors import BalanceError, HeldOutErrors
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.rig import assembly

BOTH = ("piston.pressure_1", "piston.pressure_2")


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> MachineData:
    """A piston that is led to and fro beside a supply whose sensor reads 0.4 bar too much."""
    rig = benches.bench(tmp_path_factory.mktemp("supply"))
    led = benches.led(rig, 2.0)
    table = benches.recording(led.time, {**led.columns, "supply.pressure": np.full(len(led.time), 7.4e5)})
    model = load(rig)
    links = linkages(rig, model)
    cylinders = {"piston": tuple(cylinder_runs(table, rig, model, links))}
    return MachineData(rig, model, links, (table,), (table,), cylinders, {})


def gain(column: str, factor: float, also: tuple[str, ...] = ()) -> Finding:
    parameters = {"factor": Estimate(factor, "1", factor - 0.003, factor + 0.003)}
    return Finding("sensor_scale", column, Kind.SENSOR, "", parameters, 300.0, 0.0, also=also)


def examined(data: MachineData, *findings: Finding, error: float = 1.0) -> Examination:
    model = GasModel(data.cylinders["piston"], PlantParameters(assembly.world(data.rig), assembly.cylinders(data.rig)), Split({}))
    final = FittedModel((), Fit((), {}, np.zeros(model.size), np.zeros((model.size, 0))))
    gas = SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final, findings=findings)
    validation = HeldOutErrors(balances={(Subsystem.GAS, "piston"): BalanceError(error, 1.0, 5.0, 0.0)})
    return Examination(data, Plan(Split({})), Results((gas,)), (), HeldOutErrors(), validation)


def test_equal_gains_of_all_sensors_are_one_of_the_supply(data: MachineData) -> None:
    assert set(shared_gains(examined(data, gain(BOTH[0], 0.9436), gain(BOTH[1], 0.9437)))) == set(BOTH)
    assert set(shared_gains(examined(data, gain(BOTH[0], 0.9436, also=BOTH[1:])))) == set(BOTH)
    for findings in ((gain(BOTH[0], 0.9436),), (gain(BOTH[0], 0.9436), gain(BOTH[1], 0.97)), ()):
        assert shared_gains(examined(data, *findings)) == {}


def test_without_a_recorded_supply_nothing_is_said_of_it(data: MachineData) -> None:
    (table,) = data.recordings
    bare = replace(table, columns={key: values for key, values in table.columns.items() if key != "supply.pressure"})
    assert shared_gains(examined(replace(data, recordings=(bare,)), gain(BOTH[0], 0.9436), gain(BOTH[1], 0.9437))) == {}


def test_the_supply_is_put_right_and_said_to_be_off(data: MachineData) -> None:
    right = put_right(data, {key: gain(key, 0.945) for key in BOTH})
    (finding,) = right.sensors
    assert (finding.name, finding.where) == ("sensor_scale", "supply.pressure") and finding.confidence < 0.9
    factor = finding.parameters["factor"]
    assert factor.low < factor.value < factor.high and factor.value == pytest.approx(1.0 / 0.945)
    np.testing.assert_allclose(right.recordings[0]["supply.pressure"], 0.945 * 7.4e5)
    assert right.as_read is data.as_read  # what was handed in stays: the improved rig says it of the sensor


@pytest.mark.parametrize(("after", "seconds", "accused"), [(1.0, 1e3, False), (2.0, 1e3, True), (1.0, 0.0, True)])
def test_what_holds_with_the_supply_put_right_accuses_no_chamber_and_else_none_as_certain(
    monkeypatch: pytest.MonkeyPatch, data: MachineData, after: float, seconds: float, accused: bool
) -> None:
    def again(data: MachineData, *rest: Any) -> Examination:
        return examined(replace(data, cylinders={**data.cylinders}), error=after)

    monkeypatch.setattr(shared_supply, "examine_until_stable", again)
    monkeypatch.setattr(shared_supply, "put_right", lambda data, gains: data)
    before = examined(data, gain(BOTH[0], 0.9436), gain(BOTH[1], 0.9437))
    found, _ = with_supply_put_right(before, SERIAL, print, Budget(seconds), data)
    findings = [finding for one in found.results.gas for finding in one.findings]
    assert bool(findings) is accused
    for finding in findings:
        assert finding.confidence < 0.5 and any("supply.pressure" in rival for rival in finding.ambiguous_with)


def test_where_no_gains_agree_nothing_is_examined_again(data: MachineData) -> None:
    before, budget = examined(data, gain(BOTH[0], 0.9436)), Budget()
    assert with_supply_put_right(before, SERIAL, print, budget, data) == (before, budget)
