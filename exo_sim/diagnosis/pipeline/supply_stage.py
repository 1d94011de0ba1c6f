"""The measured supply, judged by what all cylinders together drew from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.coarse_clock import begins_with
from exo_sim.diagnosis.data.computed_columns import was_computed
from exo_sim.diagnosis.data.cylinder_run import CylinderRun
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
from exo_sim.diagnosis.subsystems.supply.model import SupplyModel, SupplyRun
from exo_sim.recording.noise import white_noise
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
    known = _known(data, gas)
    if not known:
        return ()
    pressures = {name: data.table(name)["supply.pressure"] for name in known}
    level = max(float(np.nanpercentile(pressure, 95.0)) for pressure in pressures.values())
    least = significance.SUPPLY_SIGNIFICANT * level
    noise = {name: white_noise(pressure) for name, pressure in pressures.items()}
    if all(float(np.nanstd(pressure)) < max(QUIET * noise[name], least) for name, pressure in pressures.items()):
        return ()  # it never sags
    drawn = _drawn(data, gas, plan, known)
    tables = [data.table(name) for name in known]
    runs = [SupplyRun(one.name, one.time, pressures[one.name], drawn[one.name], noise[one.name], was_computed(one)) for one in tables]
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


def _known(data: MachineData, gas: Sequence[SubsystemResult[GasModel]]) -> list[str]:
    """Return the recordings in which the supply was measured and all cylinders are known throughout."""
    cylinders: dict[str, int] = {}
    for run in (run for one in gas for run in one.model.all_runs if _says_what_it_drew(data, run)):
        cylinders[run.recording] = cylinders.get(run.recording, 0) + 1
    return [name for name, count in cylinders.items() if count == len(data.rig.cylinders)]


def _says_what_it_drew(data: MachineData, run: CylinderRun) -> bool:
    """Return whether a run has the supply, from the beginning of its recording: one that was cut short says nothing of before."""
    table = data.table(run.recording)
    return run.supply is not None and "supply.pressure" in table and begins_with(run.time, table.time)


def _drawn(
    data: MachineData, gas: Sequence[SubsystemResult[GasModel]], plan: Plan, known: Sequence[str]
) -> dict[str, Array]:
    """Return what all cylinders together drew in some recordings [kg/s], on their clocks."""
    drawn: dict[str, Array] = {}
    for one in gas:
        whole = one.model.over_whole_runs(one.final_plant, plan.split)
        for index, run in enumerate(whole.runs):
            if run.recording in known:
                flow = np.interp(data.table(run.recording).time, run.time, whole.predict(whole.nominal, index).drawn)
                drawn[run.recording] = drawn.get(run.recording, 0.0) + flow
    return drawn
