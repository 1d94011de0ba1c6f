"""One round: every subsystem searched and judged on one division of the time, and held against the time that was held out."""

from __future__ import annotations

from dataclasses import replace

from exo_sim.diagnosis.coupling.corrected_pressures import with_corrected_pressures
from exo_sim.diagnosis.coupling.imputed_pressure import with_imputed_pressures
from exo_sim.diagnosis.coupling.piston_friction import Friction, friction_behind_soft_transmissions, is_soft
from exo_sim.diagnosis.data import open_questions
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.estimation.threads import Threads
from exo_sim.diagnosis.pipeline.contradiction import contradicted_faults
from exo_sim.diagnosis.pipeline.freed_memory import return_freed
from exo_sim.diagnosis.pipeline.gas_stage import Searched, examine_gas
from exo_sim.diagnosis.pipeline.hidden_give import friction_behind_hidden_give
from exo_sim.diagnosis.pipeline.motion_stage import JudgedBalances, balances_left_open, examine_motion
from exo_sim.diagnosis.pipeline.plan import Examination, Plan, Progress, Results
from exo_sim.diagnosis.pipeline.supply_stage import examine_supply
from exo_sim.diagnosis.policy.budgets import VALIDATION_UNTIL
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import unknown_effects
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.validation.held_out import held_out_errors


def examine(
    data: MachineData, plan: Plan, threads: Threads, report: Progress, searched: Searched | None = None,
    judged: JudgedBalances | None = None,
) -> Examination:  # fmt: skip
    """Return the results of the gas, then of the supply that it draws from, then of the forces, whose pressures the gas corrects.

    Args:
        data: The recordings and the rig.
        plan: What is asked, of which time.
        threads: Threads.
        report: Called with a few words on what is going on.
        searched, judged: What earlier rounds searched, and judged.
    """
    data, gas = examine_gas(data, plan, threads, report, searched)
    return_freed()  # what its fits took
    uncorrected = with_imputed_pressures(data, gas, plan.split)
    data = with_corrected_pressures(uncorrected, gas, plan.split)
    results = Results(gas, examine_supply(data, gas, plan, threads, report), examine_motion(data, plan, threads, report, judged))
    contradicted = contradicted_faults(uncorrected, results, plan, threads, report)
    data = replace(data, open_questions=(*data.open_questions, *balances_left_open(results.motion)))
    return Examination(data, plan, _shared_once(results), contradicted=contradicted)


def friction_to_add(examination: Examination) -> Friction | None:
    """Return the friction of pistons that the gas must be examined with once more; None where it need not be."""
    results = examination.results
    found = friction_behind_soft_transmissions(results.gas, results.motion)
    interrupted = any(not one.is_empty and one.search.interrupted for one in results.all)
    if not found and not interrupted:
        found = _friction_behind_hidden_give(examination)
    return found if found or interrupted else None


def _friction_behind_hidden_give(one: Examination) -> Friction:
    """Return the friction of pistons beside which the gas asks for a transmission that gives."""
    joints = {gas.where: one.data.joint_of(gas.where) for gas in one.results.gas}
    return friction_behind_hidden_give(one.results.gas, one.results.motion, one.plan.split, joints)


def validated(examination: Examination) -> Examination:
    """Return an examination with its unknown effects, and its errors on validation and test time."""
    examination.plan.budget.allow_until(VALIDATION_UNTIL)
    examination = _without_doubtful_remainders(examination)
    split, results = examination.plan.split, examination.results.all
    return_freed()  # what was searched with
    unknown = unknown_effects(results)
    validation = held_out_errors(results, unknown, split.validation_as_test(), keep_series=False) if split.validation else None
    return replace(examination, unknown=unknown, validation=validation, test=held_out_errors(results, unknown, split))


def left_open(examination: Examination, result: SubsystemResult[MotionModel]) -> Examination:
    """Return an examination in which the remainder of a balance of forces is an open question, for one of its pressures was imputed."""
    data, results = examination.data, examination.results
    unresolved = replace(result, has_unknown=False, is_unresolved=True)
    motion = tuple(unresolved if one.key == result.key else one for one in results.motion)
    question = open_questions.of_remainder(result.where)
    return replace(
        examination,
        data=replace(data, open_questions=(*data.open_questions, question)),
        results=replace(results, motion=motion),
    )


def _without_doubtful_remainders(examination: Examination) -> Examination:
    """Return an examination without unknown effects of forces whose transmission was found to give, or one of whose pressures was imputed.

    The balance takes the transmission for rigid; of an imputed pressure nobody knows what the unmeasured chamber does.
    """
    soft = {f.where for one in examination.results.all for f in one.findings if is_soft(f.name)}
    for one in examination.results.motion:
        if one.has_unknown and one.model.has_imputed_pressure:
            examination = left_open(examination, one)
    motion = tuple(replace(one, has_unknown=one.has_unknown and one.where not in soft) for one in examination.results.motion)
    return replace(examination, results=replace(examination.results, motion=motion))


def _shared_once(results: Results) -> Results:
    """Return results in which an effect of the shared supply or exhaust stands where its odds are greatest, and only there."""
    best: dict[tuple[str, str], tuple[float, object]] = {}
    for one in results.all:
        for finding in one.findings:
            at = finding.name, finding.where
            if at not in best or finding.log10_odds > best[at][0]:
                best[at] = finding.log10_odds, one.key
    return results.keeping(lambda one, finding: best[finding.name, finding.where][1] == one.key)
