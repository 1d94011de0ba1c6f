"""The gas as a least-squares problem: predictions, errors and rows."""

from __future__ import annotations

import gc
import weakref
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import benches
import numpy as np
import pytest
from diagnosis import cylinder_runs as cylinder_runs_of

from exo_sim.diagnosis.data.cylinder_run import cylinder_runs
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.policy.healthy import GAS_BOUND, USUAL_LEVEL
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.subsystems.gas import model as gas_model
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.physics.plant_records import CYLINDER, WORLD
from exo_sim.recording import Recording
from exo_sim.rig import Rig, assembly

PARTS = Split({})


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return benches.bench(tmp_path_factory.mktemp("gas"))


@pytest.fixture(scope="module")
def table(rig: Rig) -> Recording:
    return benches.led(rig, 3.0)


def test_a_prediction_of_nothing_but_pressures_is_the_same(rig: Rig, table: Recording) -> None:
    model = load(rig)
    plant = PlantParameters(assembly.world(rig), assembly.cylinders(rig))
    gas = GasModel(cylinder_runs(table, rig, model, linkages(rig, model)), plant, PARTS)
    whole, plain = gas.predict(plant, 0), gas.predict(plant, 0, whole=False)
    np.testing.assert_array_equal(plain.pressure, whole.pressure)
    assert plain.drawn.size == plain.inside.size == plain.temperature.size == 0
    measured = np.column_stack([table["piston.pressure_1"], table["piston.pressure_2"]])
    np.testing.assert_array_equal(gas.errors(plant)[0], measured[: len(whole.pressure)] - whole.pressure)


def test_a_model_that_nobody_asks_any_more_holds_no_memory(rig: Rig, table: Recording) -> None:
    """An hour's arrays hang on it: they cannot wait until the collector comes by."""
    model = load(rig)
    plant = PlantParameters(assembly.world(rig), assembly.cylinders(rig))
    gc.disable()
    try:
        gas = GasModel(cylinder_runs(table, rig, model, linkages(rig, model)), plant, PARTS)
        gas.residual_of(plant)
        gone = weakref.ref(gas)
        del gas
        assert gone() is None
    finally:
        gc.enable()


def test_a_bias_larger_than_a_reading_is_tried_and_no_refusal(rig: Rig, table: Recording) -> None:
    """A chamber begins at the atmosphere, and a fit may ask what a sensor would say that reads 1.2 bar too much."""
    model = load(rig)
    plant = PlantParameters(assembly.world(rig), assembly.cylinders(rig))
    columns = {name: values.copy() for name, values in table.columns.items()}
    columns["piston.pressure_1"][:] = 101325.0
    low = Recording(table.name, table.time, columns, table.units)
    gas = GasModel(cylinder_runs(low, rig, model, linkages(rig, model)), plant, PARTS)
    biased = PlantParameters(plant.world, plant.cylinder, {"pressure_1.bias": 1.2e5})
    assert np.isfinite(gas.predict(biased, 0).pressure).all()


def test_what_a_prediction_leaves_of_a_recording_without_noise_does_not_ring(rig: Rig, table: Recording) -> None:
    """A simulated recording has no noise; some pascal in bursts are then what the smoothed position leaves, and no hose."""
    model = load(rig)
    plant = PlantParameters(assembly.world(rig), assembly.cylinders(rig))

    def rings(size: float) -> bool:
        wave = size * np.sin(1500.0 * table.time) * (np.sin(6.0 * table.time) > 0.9)
        columns = {**table.columns, "piston.pressure_1": table["piston.pressure_1"] + wave}
        shaken = Recording(table.name, table.time, columns, table.units)
        return GasModel(cylinder_runs(shaken, rig, model, linkages(rig, model)), plant, PARTS).has_bursts(plant)

    assert not rings(0.0) and not rings(20.0) and rings(1000.0)


def test_the_set_pressure_may_be_other_than_believed(rig: Rig, table: Recording) -> None:
    model = load(rig)
    plant = PlantParameters(assembly.world(rig), assembly.cylinders(rig))
    columns = {**table.columns, "piston.valve_command": 0.1 * np.sign(np.sin(9.0 * table.time))}
    runs = cylinder_runs(Recording(table.name, table.time, columns, table.units), rig, model, linkages(rig, model))
    lower = plant.copy()
    lower.world["supply_pressure"] *= 0.98
    scaled = PlantParameters(plant.world, plant.cylinder, {"supply.scale": 0.98})
    wanted = GasModel(runs, lower, PARTS).predict(lower, 0).pressure
    found, believed = (GasModel(runs, plant, PARTS).predict(one, 0).pressure for one in (scaled, plant))
    np.testing.assert_allclose(found, wanted, rtol=1e-9)
    assert np.ptp(found - believed) > 1e3


def test_what_a_healthy_gas_may_miss_is_in_proportion_to_what_drives_it() -> None:
    """A chamber that a light spring empties stays far below its supply, from which all of its flow comes."""
    world = np.zeros(1, WORLD)
    world["supply_pressure"] = 6e5
    cylinder = np.zeros(1, CYLINDER)
    cylinder["area_1"], cylinder["area_2"], cylinder["stroke"] = 1e-3, 1e-3, 0.2

    def bound(pressure: float, commanded: bool) -> float:
        run = cylinder_runs_of.run_of(pressure + np.random.default_rng(1).normal(0.0, 100.0, 4000), commanded=commanded)
        gas = GasModel([run], PlantParameters(world, cylinder), PARTS)
        return gas.discrepancy_bound / gas.practical_significance

    assert bound(1.5e5, commanded=False) == bound(4e5, commanded=True) == pytest.approx(GAS_BOUND)
    assert bound(1.5e5, commanded=True) == pytest.approx(GAS_BOUND * USUAL_LEVEL * 6e5 / 1.5e5, rel=1e-3)


def test_what_threads_predict_at_once_is_counted_once_each(rig: Rig, table: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever each of them has read of the count before: a search that ends after so many predictions must not depend on that."""
    model = load(rig)
    plant = PlantParameters(assembly.world(rig), assembly.cylinders(rig))
    gas, both = GasModel(cylinder_runs(table, rig, model, linkages(rig, model)), plant, PARTS), Barrier(2)

    def together(*asked: object) -> int:
        both.wait(10.0)
        return 7

    before = gas.effort.samples
    monkeypatch.setattr(gas_model, "effort_of", together)
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda number: gas.predict(plant, 0), range(2)))
    assert gas.effort.samples - before == 14


def test_what_the_form_of_the_flow_law_predicted_that_fits_worse_counts_as_well(
    rig: Rig, table: Recording, monkeypatch: pytest.MonkeyPatch
) -> None:
    model, asked = load(rig), list[object]()

    def noted(*given: object) -> int:
        asked.append(given)
        return 7

    plant = PlantParameters(assembly.world(rig), assembly.cylinders(rig))
    gas = GasModel(cylinder_runs(table, rig, model, linkages(rig, model)), plant, PARTS)
    before = gas.effort.samples
    monkeypatch.setattr(gas_model, "effort_of", noted)
    monkeypatch.setattr(gas_model, "critical_ratio", lambda k: 0.05)
    chosen, _ = gas.with_better_flow_law(())
    assert chosen is gas and chosen.effort.samples - before == 7 * len(asked) >= 14


@pytest.mark.parametrize(("single", "twins"), [(0.0, ()), (1.0, ("piston_leakage",))])
def test_what_leaves_a_single_acting_cylinder_may_leave_by_its_piston(single: float, twins: tuple[str, ...]) -> None:
    cylinder = np.zeros(1, CYLINDER)
    cylinder["area_1"], cylinder["area_2"], cylinder["stroke"], cylinder["single_acting"] = 1e-3, 1e-3, 0.2, single
    run = cylinder_runs_of.run_of(np.full(400, 3e5), None)
    gas = GasModel([run], PlantParameters(np.zeros(1, WORLD), cylinder), Split({}))
    leak = Finding("external_leakage", "piston", Kind.MISSING_PHYSICS, "", {"area_1": Estimate(1e-8, "m^2", 9e-9, 1.1e-8)}, 9.0, 0.5)
    assert gas.indistinguishable([leak], FittedModel.at({}).fit).get(leak.at, ()) == twins
