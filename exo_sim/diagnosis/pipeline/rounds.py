"""Rounds until nothing changes: what a round finds may revise the plan of the next.

The revisions, in this order:

1. Forces were found to resist a piston behind a transmission that gives, or that gives with them alone (`hidden_give`): the gas is
   examined once more with them.
2. Forces contradict a sensor's fault that the gas asks for, or validation refutes effects: they are not sought again, and the friction is
   found anew.
3. The validation error is much larger than what the fit leaves, and larger than a healthy machine's: the time that was fitted lacks
   something, and the beginning of the recording is held out instead of its end. The division counts whose fit lacks nothing, of two alike
   the one with the smaller ratio of the two errors.

Where a balance of forces has hardly any rows but those of the end (a piston that sticks until then), the beginning is held out first.

A refutation is taken back where more is missed without what it refuted, of the time that was fitted and of validation time.

No round is repeated: the first revision happens once for every set of refuted effects, the second at most `MOST_REFUTATIONS` times for
a division of time, the third once. The last of the second takes back whatever is still refuted without searching anew.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split, split
from exo_sim.diagnosis.estimation.budget import Budget
from exo_sim.diagnosis.estimation.threads import Threads
from exo_sim.diagnosis.findings import Finding, Kind, held_out_key
from exo_sim.diagnosis.outcome.held_out_rules import doubt, is_refuted, too_small
from exo_sim.diagnosis.pipeline.examine import examine, friction_to_add, left_open, validated
from exo_sim.diagnosis.pipeline.gas_stage import Searched
from exo_sim.diagnosis.pipeline.motion_stage import JudgedBalances, judged_balances
from exo_sim.diagnosis.pipeline.plan import Examination, Plan, Progress, Refuted
from exo_sim.diagnosis.policy import validation as policy
from exo_sim.diagnosis.policy.budgets import MOST_REFUTATIONS, MOST_ROUNDS
from exo_sim.diagnosis.selection.finding_removal import without_findings
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import unknown_effects
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.diagnosis.validation.held_out import held_out_errors
from exo_sim.diagnosis.validation.long_run import Straying, straying
from exo_sim.physics.effects.unknown import EFFECT as UNKNOWN

Model = TypeVar("Model", bound=SubsystemModel)


def examine_until_stable(data: MachineData, threads: Threads, report: Progress, budget: Budget | None = None) -> Examination:
    """Return the examination that no revision changes any more, or the last one within the budget; without one there is no end."""
    budget = budget or Budget()
    times = [(table.name, table.time) for table in data.recordings]
    head = _moves_in_the_end(data, split(times), split(times, head=True))
    plan, stable = Plan(split(times, head=head), budget=budget), list[Examination]()
    searched, judged, before = Searched(), JudgedBalances(), None
    for _ in range(MOST_ROUNDS):
        found = examine(data, plan, threads, report, searched, judged)
        friction = friction_to_add(found) if plan.friction is None and not budget.is_spent() else None
        if friction is not None:
            report("examining the gas once more with the friction of its piston")
            plan = replace(plan, friction=friction)
            continue
        report("validating on time held out")
        found = validated(found)
        if before is not None and (missed := missed_without(before, found)):
            plan = replace(before.plan, refutations=plan.refutations, upheld=before.plan.upheld | missed)
            found = replace(before, plan=plan)
        refuted = found.contradicted or newly_refuted(found)
        before = found if refuted and not found.contradicted else None
        if refuted:
            refutations = plan.refutations + 1
            plan = replace(plan, refuted={**plan.refuted, **refuted}, friction=None, refutations=refutations)
            if refutations < MOST_REFUTATIONS and not budget.is_spent():
                continue
            found = _without_all_refuted(replace(found, plan=plan))
        stable.append(found)
        if len(stable) > 1 or not _lacking(found)[0] or budget.is_spent():
            break
        report(f"the validation time shows what the fit never met: the {'end' if head else 'beginning'} is held out instead")
        plan, before = Plan(split(times, head=not head), budget=budget), None
    return min(stable, key=_lacking)


def _lacking(one: Examination) -> tuple[bool, float]:
    """Return by what the better of two divisions of time is chosen: that its fit lacks nothing, then the ratio of its errors."""
    return one.validation is not None and one.validation.lacks(policy.LACKING_RATIO), one.validation_ratio


def _moves_in_the_end(data: MachineData, end: Split, beginning: Split) -> bool:
    """Return whether the beginning is to be held out, because without the end of the recordings fewer balances of forces can be judged."""
    judged = judged_balances(data, end)
    return judged < len(data.joints) and judged < judged_balances(data, beginning)


def newly_refuted(examination: Examination) -> Refuted:
    """Return of each balance the least certain of the findings that validation refutes, and why: it may be what spoils the others."""
    if examination.validation is None:
        return {}
    found, gains = {}, examination.checked.gains
    for one in examination.results.all:
        if one.search.unnamed:  # names were found beside it, and it is not known for the held-out time
            continue
        useless = []
        for finding in (finding for finding in one.findings if finding.at not in examination.plan.upheld):
            drop = examination.validation.drops.get(finding.key)
            influence = examination.validation.influence.get(finding.key, 0.0)
            if drop is None or influence <= policy.LEAST_INFLUENCE:
                continue
            if is_refuted(drop, finding.log10_odds, gains.get(finding.key), one.search.weighed_together):
                useless.append((finding.log10_odds, drop, finding.name, finding.where))
        for _, drop, name, where in sorted(useless)[:1]:  # without it the others may gain more
            says = "does not fall" if drop <= 0.0 else f"falls by no more than {100 * drop:.0f} %"
            found[name, where] = f"on time that no number was fitted to, the error {says} with it"
    return found


def missed_without(before: Examination, after: Examination) -> frozenset[tuple[str, str]]:
    """Return the findings whose refutation left more: what was found in their place explains less of what was fitted and of held-out time.

    A dip of friction that hardly acts in held-out time may be all that makes the others fit: without it they give way to wrong names.

    Args:
        before: An examination of which findings were refuted.
        after: The examination without them.
    """
    gone, found = after.plan.refuted.keys() - before.plan.refuted.keys(), set()
    for one in before.results.all:
        was, now = (each.checked.balances.get(one.key) for each in (before, after))
        if was is not None and now is not None and now.fitted > was.fitted and now.error > (1.0 + policy.MOST_RISE) * was.error:
            found |= gone & {finding.at for finding in one.findings}
    return frozenset(found)


def _without_all_refuted(examination: Examination) -> Examination:
    """Return an examination without the findings that were refuted, nor those that are still refuted beside the rest.

    No round is left in which what spoils others would come out last.
    """
    found = _without_refuted(examination)
    while refuted := newly_refuted(found):
        found = _without_refuted(replace(found, plan=replace(found.plan, refuted={**found.plan.refuted, **refuted})))
    return found


def _without_refuted(examination: Examination) -> Examination:
    """Return an examination without the findings that were refuted; the numbers of the others are found anew, and their errors."""
    refuted, before, split = examination.plan.refuted, examination.results, examination.plan.split

    def rest(one: SubsystemResult[Model]) -> SubsystemResult[Model]:
        return without_findings(one, refuted, split) if any(f.at in refuted for f in one.findings) else one

    results = before.each(rest)
    anew = [one for one, old in zip(results.all, before.all, strict=True) if one.final is not old.final]
    if not anew:
        return replace(examination, results=results)
    unknown, gone = unknown_effects(results.all), [held_out_key(*at) for at in refuted]
    validation = examination.validation
    if validation is not None:
        validation = validation.updated(held_out_errors(anew, unknown, split.validation_as_test()), gone)
    test = examination.test.updated(held_out_errors(anew, unknown, split), gone)
    return replace(examination, results=results, unknown=unknown, validation=validation, test=test)


def without_doubtful(examination: Examination) -> Examination:
    """Return an examination without the findings that are more likely wrong than right by the time that no number was fitted to."""
    doubtful, shares = {}, examination.shares
    for one in examination.results.all:
        for finding in (finding for finding in one.findings if finding.at not in examination.plan.upheld):
            why = doubt(finding, shares.get(finding.key), finding.key in examination.checked.drops, one.has_unknown)
            if why:
                doubtful[finding.at] = why
    plan = replace(examination.plan, refuted={**examination.plan.refuted, **doubtful})
    return without_doubtful(_without_refuted(replace(examination, plan=plan))) if doubtful else examination


def without_small(examination: Examination) -> Examination:
    """Return an examination that holds what is too small to matter beside its findings, not among them."""
    seen = examination.checked
    errors = seen.left, seen.where_acting, seen.beyond_healthy, seen.tested, seen.relief
    return examination.holding_small(tuple(f for one in examination.results.all for f in too_small(one, *errors)))


def with_test_findings(examination: Examination) -> tuple[Examination, list[Finding]]:
    """Return a finding for every balance whose test time shows something that the rest of the time never met, or windows do not.

    So it is also where the fit of a lone recording looks healthy, and validation and test exceed the discrepancy bound. Where a pressure
    of the balance was imputed, that is an open question of the examination instead.
    """
    found = []
    for balance in examination.results.motion:
        if balance.model.has_imputed_pressure and _in_the_test(examination, balance):
            examination = left_open(examination, balance)
    unresolved = {one.key for one in examination.results.motion if one.is_unresolved}
    for one in examination.results.all:
        says = _in_the_test(examination, one)
        if one.has_unknown or one.key in unresolved:
            continue
        if says:
            error = examination.test.balances[one.key]
            found.append(Finding(UNKNOWN.name, one.where, Kind.UNKNOWN, says, {}, error.log10_odds, 0.0))
        elif (strayed := straying(one, examination.plan.split)) is not None and strayed.beyond > policy.STRAYED:
            found.append(Finding(UNKNOWN.name, one.where, Kind.UNKNOWN, _adds_up(one, strayed), {}, strayed.log10_odds, 0.0))
    return examination, found


def _in_the_test(examination: Examination, one: SubsystemResult[SubsystemModel]) -> str:
    """Return what the test time shows of a balance that the rest did not, in words, or ""."""
    test = examination.test.balances.get(one.key)
    if test is None:
        return ""
    validation = examination.validation.balances.get(one.key) if examination.validation else None
    ratio = test.ratio > (policy.TEST_RATIO_BEYOND_BOUND if test.exceeds_bound() else policy.TEST_RATIO)
    lasting = validation is not None and validation.newly_exceeds_bound() and test.newly_exceeds_bound(policy.CLEARLY_BEYOND)
    if not ratio and not lasting:
        return ""
    often = f"{test.ratio:.0f} times as much as in the rest" if ratio else "by more than any healthy machine's is"
    what = "something acts there that the rest never met" if ratio else "what holds of the rest does not hold there"
    return f"In held-out time the {one.model.balance} of {one.where} is missed {often}: {what}; record more of it."


def _adds_up(one: SubsystemResult[SubsystemModel], strayed: Straying) -> str:
    """Return that something adds up which windows do not show, in words."""
    return (
        f"Run from its first measured state the {one.model.balance} of {one.where} strays over held-out time by "
        f"{strayed.error:.0f} times the noise; losses of a healthy machine and uncertain numbers explain {strayed.explained:.0f}. "
        "Something slow acts that has no name and that windows do not show; record a long hold with every path closed."
    )
