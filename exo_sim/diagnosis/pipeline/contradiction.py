"""Faults of sensors that the gas asks for, held against the forces: both hang on the same pressures.

The balances of forces are made of pressures that are rid of what the gas calls a sensor's fault. Where that is no fault, the gas is
mended by it and the forces are spoilt, or mended in their turn by a fault of another sensor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from exo_sim.diagnosis.coupling.corrected_pressures import Correction, correction_of, with_corrections
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.correlation import rms
from exo_sim.diagnosis.estimation.threads import Threads
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.outcome.sensor_faults import faulty_scales, faulty_zeros
from exo_sim.diagnosis.pipeline.motion_stage import examine_balance
from exo_sim.diagnosis.pipeline.plan import Plan, Progress, Refuted, Results
from exo_sim.diagnosis.policy.validation import CONTRADICTED
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.motion.model import MotionModel

Balance = SubsystemResult[MotionModel]


def contradicted_faults(
    uncorrected: MachineData, results: Results, plan: Plan, threads: Threads, report: Progress
) -> Refuted:
    """Return the faults of sensors by effect and place that the gas asks for and a balance of forces speaks against, and why.

    Each is asked alone, for a true fault may stand beside a false one, and all together where none falls alone.

    Args:
        uncorrected: The data before the gas corrected any pressure.
        results: Of the gas and of the balances as it corrected them.
        plan, threads, report: As in `examine`.
    """
    asking, found = _Asking(uncorrected, results, plan, threads, report), dict[tuple[str, str], str]()
    for one in results.gas:
        faults = [candidate for candidate in one.named if candidate.kind is Kind.SENSOR]
        if not faults or one.has_unknown or plan.budget.is_spent():
            continue
        own = {fault.at: asking.against(one, [fault]) for fault in faults}
        if not any(own.values()) and len(faults) > 1:
            own = dict.fromkeys(own, asking.against(one, faults))
        found |= {at: why for at, why in own.items() if why}
    return found


@dataclass(frozen=True)
class _Asking:
    """What is asked of the forces; attributes as the arguments of `contradicted_faults`."""

    uncorrected: MachineData
    results: Results
    plan: Plan
    threads: Threads
    report: Progress

    @cached_property
    def _corrections(self) -> list[Correction]:
        """What each cylinder's gas asks for, as if all its faults were there."""
        return [correction_of(self.uncorrected, each, self.plan.split) for each in self.results.gas]

    def against(self, one: SubsystemResult[GasModel], suspects: Sequence[Candidate]) -> str:
        """Return what the forces of a cylinder say against some faults of its sensors, "" for nothing."""
        innocent = replace(one, named=tuple(candidate for candidate in one.named if candidate not in suspects))
        own = correction_of(self.uncorrected, innocent, self.plan.split)
        corrections = [own if each is one else asked for each, asked in zip(self.results.gas, self._corrections, strict=True)]
        without = with_corrections(self.uncorrected, corrections)
        for balance in self.results.motion:
            if balance.where != one.where or balance.is_empty:
                continue
            runs = _of_the_same_recordings(without[balance.name], balance.model.runs)
            if not _differ(balance.model.runs, runs):
                continue
            self.report(f"{balance.name}: asking whether its forces bear a fault of a sensor")
            why = _against(balance, examine_balance(balance.name, runs, self.uncorrected, self.plan, self.threads, self.report))
            if why:
                return why
        return ""


def _of_the_same_recordings(runs: Sequence[MotionRun], judged: Sequence[MotionRun]) -> tuple[MotionRun, ...]:
    """Return the runs of those recordings that were judged: a corrected one may have proved to be driven from outside."""
    names = {run.recording for run in judged}
    return tuple(run for run in runs if run.recording in names)


def _differ(first: Sequence[MotionRun], second: Sequence[MotionRun]) -> bool:
    """Return whether the driving forces of a balance differ."""
    return any(not np.array_equal(a.drive.force, b.drive.force, equal_nan=True) for a, b in zip(first, second, strict=True))


def _against(with_it: Balance, without_it: Balance) -> str:
    """Return what a balance of forces says against a fault, "" for nothing."""
    if without_it.is_empty or _faults(without_it):  # these may be of the very sensor
        return ""
    if _left(with_it) > CONTRADICTED * max(_left(without_it), 1.0):
        return "forces close without it and not with it"
    if _faults(with_it) and _left(without_it) <= _left(with_it):
        return "with it forces ask for a sensor's fault in their turn, and without it for none"
    return ""


def _left(balance: Balance) -> float:
    """Return what a balance leaves where it was fitted [units of the noise]."""
    return rms(balance.final.fit.residual)


def _faults(balance: Balance) -> set[tuple[str, str]]:
    """Return the faults of sensors that a balance asks for, by name or by scales and zeros further off than any data sheet allows."""
    named = {candidate.at for candidate in balance.named if candidate.kind is Kind.SENSOR}
    return named | {finding.at for finding in (*faulty_scales([balance], ()), *faulty_zeros([balance], ()))}
