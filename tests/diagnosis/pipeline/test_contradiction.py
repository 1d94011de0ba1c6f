"""Faults of sensors held against the forces: one that spoils a balance falls, a true one stays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.coupling.corrected_pressures import corrected_balances
from exo_sim.diagnosis.data.cylinder_run import cylinder_runs
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.estimation.threads import SERIAL
from exo_sim.diagnosis.pipeline.contradiction import contradicted_faults
from exo_sim.diagnosis.pipeline.motion_stage import examine_motion
from exo_sim.diagnosis.pipeline.plan import Plan, Refuted, Results
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.candidates import candidates
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.motion.motion_runs import motion_runs
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.recording import Recording
from exo_sim.rig import Rig, assembly

PARTS = Split({})
AT = ("sensor_scale", "piston.pressure_1")
FACTOR = 1.15


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return benches.bench(tmp_path_factory.mktemp("contradicted"))


@pytest.fixture(scope="module")
def table(rig: Rig) -> Recording:
    """A mass that its cylinder moves, and noise as sensors have it."""
    clean, noise = benches.recorded(rig), np.random.default_rng(11)
    size = {"pressure": 150.0, "position": 1e-5}
    columns = {key: v + noise.normal(0.0, size.get(key.split(".")[1][:8], 0.0), len(v)) for key, v in clean.columns.items()}
    return replace(clean, columns=columns)


def refuted(rig: Rig, tables: Sequence[Recording], *names: tuple[str, str], judged: int = 9) -> Refuted:
    """Return what forces contradict of a gas that found these; of so many recordings forces are judged as they were corrected."""
    model = load(rig)
    links = linkages(rig, model)
    joints = {"slide": tuple(run for table in tables for run in motion_runs(table, rig, model, links)[0])}
    cylinders = {"piston": tuple(run for table in tables for run in cylinder_runs(table, rig, model, links))}
    data = MachineData(rig, model, links, tuple(tables), tuple(tables), cylinders, joints)
    plant = PlantParameters(assembly.world(rig), assembly.cylinders(rig))
    gas = GasModel(data.cylinders["piston"], plant, PARTS)
    named = tuple(one for one in candidates(plant, data.cylinders["piston"], "piston", "slide") if one.at in names)
    values = {one.parameters[0]: FACTOR if one.effect == "sensor_scale" else one.parameters[0].scale for one in named}
    final = FittedModel(named, Fit(tuple(values), values, np.zeros(gas.size), np.zeros((gas.size, len(values)))))
    found = (SubsystemResult("piston", gas, ModelFits(gas, ()), SearchResult(final, final), final, named=named),)
    plan = Plan(PARTS)
    corrected = replace(data, joints={name: runs[:judged] for name, runs in corrected_balances(data, found, PARTS).items()})
    results = Results(found, (), examine_motion(corrected, plan, SERIAL, lambda words: None))
    return contradicted_faults(data, results, plan, SERIAL, lambda words: None)


def test_a_fault_that_spoils_the_forces_falls(rig: Rig, table: Recording) -> None:
    found = refuted(rig, [table], AT)
    assert set(found) == {AT} and "forces" in found[AT]


def test_a_recording_whose_forces_are_not_judged_takes_no_part(rig: Rig, table: Recording) -> None:
    other = replace(table, name="other")
    assert set(refuted(rig, [table, other], AT, judged=1)) == {AT}


def test_a_true_fault_beside_a_false_one_stays(rig: Rig, table: Recording) -> None:
    true = ("sensor_scale", "piston.pressure_2")
    faulty = replace(table, columns={**table.columns, true[1]: FACTOR * table[true[1]]})
    assert set(refuted(rig, [faulty], AT, true)) == {AT}


def test_a_fault_that_mends_the_forces_stays(rig: Rig, table: Recording) -> None:
    faulty = replace(table, columns={**table.columns, AT[1]: FACTOR * table[AT[1]]})
    assert refuted(rig, [faulty], AT) == {}


def test_where_no_sensor_is_at_fault_nothing_is_asked(rig: Rig, table: Recording) -> None:
    assert refuted(rig, [table], ("piston_leakage", "piston")) == {}
