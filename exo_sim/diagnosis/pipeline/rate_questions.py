"""What a slow recording leaves open where nothing was found in its gas."""

from __future__ import annotations

from collections.abc import Sequence

from exo_sim.conventions.filling import QUICK
from exo_sim.diagnosis import wording
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.open_questions import of_rate
from exo_sim.diagnosis.findings import OpenQuestion
from exo_sim.diagnosis.outcome.unseen_effects import unseen_effects
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.candidates import candidates, sample_period
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.physics.declaration import declared


def hidden_by_rate(data: MachineData, gas: Sequence[SubsystemResult[GasModel]]) -> tuple[OpenQuestion, ...]:
    """Return, of every gas without findings whose commands are samples of a quicker loop, the question of what its rate hides.

    Args:
        data: The machine.
        gas: Results.
    """
    found = []
    for one in gas:
        runs = one.model.all_runs
        if one.is_empty or one.findings or one.has_unknown or not any(run.sampled for run in runs):
            continue
        asked = [each for each in candidates(one.model.nominal, runs, one.where, data.joint_of(one.where)) if each.effect in declared()]
        if names := unseen_effects(one, asked):
            called = ", ".join(map(wording.name_of, names))
            found.append(of_rate(one.where, 1.0 / sample_period(runs), names, called, QUICK))
    return tuple(found)
