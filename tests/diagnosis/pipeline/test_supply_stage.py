"""The stage of the supply: asked only where it was measured, sags, and all that draws from it is known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.data import coarse_clock
from exo_sim.diagnosis.data.cylinder_run import cylinder_runs
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.estimation.threads import SERIAL
from exo_sim.diagnosis.pipeline.plan import Plan
from exo_sim.diagnosis.pipeline.supply_stage import examine_supply
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.gas.nuisances import with_measured_supply
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.rig import assembly

PLAN = Plan(Split({}))


def gas(folder: Path, sag: float | None) -> tuple[MachineData, tuple[SubsystemResult[GasModel], ...]]:
    """Return a bench whose supply was recorded (or not) and sags by so many pascals for each kg/s that its own gas model draws."""
    rig = benches.bench(folder)
    table = benches.recorded(rig, 6.0)
    model = load(rig)
    links = linkages(rig, model)

    def built(pressure: np.ndarray | None) -> tuple[MachineData, SubsystemResult[GasModel]]:
        columns = dict(table.columns) if pressure is None else {**table.columns, "supply.pressure": pressure}
        one = replace(table, columns=columns, units={**table.units, "supply.pressure": "Pa"})
        runs = tuple(cylinder_runs(one, rig, model, links))
        data = MachineData(rig, model, links, (one,), (one,), {"piston": runs}, {})
        plant = with_measured_supply(PlantParameters(assembly.world(rig), assembly.cylinders(rig)), runs)
        subsystem = GasModel(runs, plant, PLAN.split)
        fits = ModelFits(subsystem, ())
        final = FittedModel((), fits.fit(()).fit)
        return data, SubsystemResult("piston", subsystem, fits, SearchResult(final, final), final)

    data, result = built(None if sag is None else np.full(len(table.time), 7e5))
    if sag:
        whole = result.model.over_whole_runs(result.final_plant, PLAN.split)
        drawn = whole.predict(whole.nominal, 0).drawn
        noise = np.random.default_rng(4).normal(0.0, 200.0, len(drawn))
        lagged = np.convolve(drawn, np.exp(-np.arange(600) / 80.0) / 80.0)[: len(drawn)]
        data, result = built(7e5 - sag * lagged + noise)
    return data, (result,)


@pytest.mark.parametrize("sag", [None, 0.0])
def test_a_supply_that_was_not_measured_or_never_sags_is_not_asked(tmp_path: Path, sag: float | None) -> None:
    data, results = gas(tmp_path, sag)
    assert examine_supply(data, results, PLAN, SERIAL, lambda words: None) == ()


def test_a_supply_that_droops_with_what_is_drawn_is_a_regulator(tmp_path: Path) -> None:
    data, results = gas(tmp_path, 4e7)
    (found,) = examine_supply(data, results, PLAN, SERIAL, lambda words: None)
    assert [finding.name for finding in found.findings] == ["supply_regulator"] and found.where == "supply" and not found.has_unknown
    assert found.findings[0].parameters["droop"].value == pytest.approx(4e7, rel=0.15)


def test_gas_on_a_coarser_clock_than_its_supply_s_is_all_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data, (fine,) = gas(tmp_path, 4e7)
    monkeypatch.setattr(coarse_clock, "FINE_PERIOD", 2e-3)
    runs = tuple(coarse_clock.on_coarse_clock(run) for run in fine.model.all_runs)
    assert len(runs[0].time) == len(data.recordings[0].time) // 2
    model = GasModel(runs, fine.model.nominal, PLAN.split)
    coarse = replace(fine, model=model, fits=ModelFits(model, ()))
    (found,) = examine_supply(data, (coarse,), PLAN, SERIAL, lambda words: None)
    assert [finding.name for finding in found.findings] == ["supply_regulator"]
    assert found.findings[0].parameters["droop"].value == pytest.approx(4e7, rel=0.15)


def test_where_the_gas_of_a_cylinder_is_not_known_the_supply_is_not_judged(tmp_path: Path) -> None:
    data, _ = gas(tmp_path, 4e7)
    assert examine_supply(data, (), PLAN, SERIAL, lambda words: None) == ()
