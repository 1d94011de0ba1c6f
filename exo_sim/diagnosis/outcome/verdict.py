"""The verdict, and what to record next."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from exo_sim.conventions.undriven import drives
from exo_sim.diagnosis import wording
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.open_questions import of_free_swing
from exo_sim.diagnosis.findings import Finding, Kind, NextExperiment, OpenQuestion, SignalFit, Subsystem
from exo_sim.diagnosis.outcome.experiments import in_which, ranked_experiments
from exo_sim.diagnosis.policy.acceptance import LEAST_ODDS
from exo_sim.diagnosis.policy.verdicts import FIRST_STATE, SWINGS_OFF
from exo_sim.diagnosis.result import Verdict
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.physics.effects.unknown import EFFECT as UNKNOWN
from exo_sim.recording.filters import smoothed
from exo_sim.recording.local_state import first_rate_error
from exo_sim.recording.table import Recording


def verdict_of(findings: Sequence[Finding], judged: Collection[Subsystem], data: MachineData) -> Verdict:
    """Return the verdict: physics or a sensor at fault, numbers off, all well, or nobody can tell.

    Args:
        findings: All of them.
        judged: The kinds of subsystem of which one was judged to the end.
        data: The machine.
    """
    if any(f.kind is not Kind.CALIBRATION for f in findings):
        return Verdict.MISMATCH
    if not data.needed_for_verdict <= set(judged):
        return Verdict.UNDETERMINED
    return Verdict.CALIBRATION if findings else Verdict.CONSISTENT


def swings_astray(data: MachineData, free_run: Mapping[str, SignalFit]) -> tuple[OpenQuestion, ...]:
    """Return the question of every joint that strays from its recording although nothing drives it.

    What is driven drifts from its recording by nature; a swing has nothing but the rig and its first state.

    Args:
        data: The machine.
        free_run: Errors of one run by column, as the rig that is written has them.
    """
    found = []
    for joint, runs in data.joints.items():
        column = f"{joint}.position"
        fit = free_run.get(column)
        if fit is None or any(drives(run.driving) for run in runs):
            continue
        spread = max(float(np.nanstd(run.kinematics.position)) for run in runs)
        off = fit.after if math.isfinite(fit.after) else spread
        by_noise = max(_by_first_rate(table, column) for table in data.recordings if column in table)
        if off > max(SWINGS_OFF * spread, FIRST_STATE * by_noise):
            found.append(of_free_swing(joint, off, spread))
    return tuple(found)


def _by_first_rate(table: Recording, column: str) -> float:
    """Return how far the noise of a position lets a swing stray by the rate that it begins with, one standard deviation."""
    position, rate, _ = smoothed(table.time, table[column])
    frequency = float(np.nanstd(rate)) / max(float(np.nanstd(position)), 1e-300)
    return first_rate_error(table.time, table[column]) / max(frequency, 1e-300)


def distinct(questions: Sequence[OpenQuestion]) -> tuple[OpenQuestion, ...]:
    """Return each open question once."""
    return tuple({(q.question, q.why): q for q in questions}.values())


def next_experiment(
    findings: Sequence[Finding], questions: Sequence[OpenQuestion], results: Sequence[SubsystemResult[SubsystemModel]] = ()
) -> NextExperiment | None:
    """Return what to record next: to separate effects that look the same, to see a curve, or to answer an open question.

    What separates two effects is simulated where both were fitted to the same `results`; an experiment that is not expected to separate
    them decisively is not proposed: then it is what the effects declare.
    """
    for finding in findings:
        if finding.ambiguous_with:
            rival = finding.ambiguous_with[0]
            one = in_which(results, finding.name, finding.where)
            ranked = ranked_experiments(one, finding.name, rival) if one is not None else ()
            why = f"{wording.name_of(finding.name)} and {wording.name_of(rival)} explain this recording equally well"
            do = ranked[0][0] if ranked and ranked[0][1] > LEAST_ODDS else wording.experiment(finding.name, rival)
            return NextExperiment(why, do, (finding.name, *finding.ambiguous_with), ranked)
    for finding in findings:
        if finding.kind is Kind.UNKNOWN:
            follows = finding.depends_on[0] if finding.depends_on else "one signal at a time"
            do = f"move {follows} alone, slowly and then fast, with the valve closed where that is possible"
            return NextExperiment("something is missing that has no name", do, (UNKNOWN.name,))
    for question in questions:
        return NextExperiment(
            f"{question.question} cannot be judged: {question.why}", question.do, question.effects
        )
    return None
