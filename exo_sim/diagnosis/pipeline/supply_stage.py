"""The measured supply, judged by what all cylinders together drew from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.coarse_clock import begins_with
from exo_sim.diagnosis.data.computed_columns import was_computed
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.estimation.threads import Threads
from exo_sim.diagnosis.pipeline.plan import Plan, Progress
from exo_sim.diagnosis.policy import significance
from exo_sim.diagnosis.policy.priors import FARTHEST_SET_PRESSURE
from exo_sim.diagnosis.policy.recordings import QUIET
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.search import Search, StoppingCriteria
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.supply.candidates import candidates, nuisance_parameters
from exo_sim.diagnosis.subsystems.supply.model import SupplyModel, SupplyRun, supply_run
from exo_sim.rig import assembly

Array = NDArray[np.float64]


def examine_supply(
    data: MachineData, gas: Sequence[SubsystemResult[GasModel]], plan: Plan, threads: Threads, report: Progress
) -> tuple[SubsystemResult[SupplyModel], ...]:
    """Return the result of the supply; nothing where it was not measured, or the gas of one cylinder is not known.

    A measured supply is an input: what a drawn flow does not explain of it is nobody's missing physics.
    """
    if len(gas) < len(data.rig.cylinders) or any(one.is_empty for one in gas):
        return ()
    runs = _runs(data, gas, plan)
    if not runs:
        return ()
    level = max(float(np.nanpercentile(run.pressure, 95.0)) for run in runs)
    if all(float(np.nanstd(run.pressure)) < max(QUIET * run.noise, significance.SUPPLY_SIGNIFICANT * level) for run in runs):
        return ()  # it never sags
    plant = PlantParameters(assembly.world(data.rig), assembly.cylinders(data.rig)[:1])
    if abs(level / float(plant.world["supply_pressure"][0]) - 1.0) > FARTHEST_SET_PRESSURE:
        plant.world["supply_pressure"] = level
    model = SupplyModel(runs, plant, plan.split)
    search = Search(
        model, nuisance_parameters(plant), plan.without_refuted(candidates(plant)), threads,
        lambda words: report(f"supply: {words}"), cheap=True,
        practical_significance=model.practical_significance, stopping=StoppingCriteria(is_spent=plan.budget.is_spent),
    )  # fmt: skip
    found = decide("supply", model, search.fits, search.run())
    return (replace(found, has_unknown=False, deviations=()),)


def _runs(data: MachineData, gas: Sequence[SubsystemResult[GasModel]], plan: Plan) -> list[SupplyRun]:
    """Return the supply's pressure and flow in every recording in which it was measured and all cylinders are known throughout."""
    drawn: dict[str, Array] = {}
    measured: dict[str, tuple[Array, Array]] = {}
    cylinders: dict[str, int] = {}
    for one in gas:
        if all(run.supply is None for run in one.model.all_runs):
            continue
        whole = one.model.over_whole_runs(one.final_plant, plan.split)
        for index, run in enumerate(whole.runs):
            table = data.table(run.recording)
            if run.supply is None or "supply.pressure" not in table or not begins_with(run.time, table.time):
                continue  # a run that was cut short does not say what its cylinder drew before
            flow = np.interp(table.time, run.time, whole.predict(whole.nominal, index).drawn)
            drawn[run.recording] = drawn.get(run.recording, 0.0) + flow
            measured[run.recording] = (table.time, table["supply.pressure"])
            cylinders[run.recording] = cylinders.get(run.recording, 0) + 1
    known = [name for name in drawn if cylinders[name] == len(data.rig.cylinders)]
    return [supply_run(name, *measured[name], drawn[name], was_computed(data.table(name))) for name in known]
