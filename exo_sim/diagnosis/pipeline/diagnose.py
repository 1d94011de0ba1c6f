"""The diagnosis from end to end: read, examine until nothing changes, and report."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from exo_sim.diagnosis.data import computed_columns
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.estimation.budget import Budget
from exo_sim.diagnosis.estimation.threads import Threads
from exo_sim.diagnosis.findings import Finding, Rejected, SignalFit, in_order
from exo_sim.diagnosis.outcome.constant_force import with_constant_force
from exo_sim.diagnosis.outcome.finding_probability import confidence
from exo_sim.diagnosis.outcome.localisation import located, unexplained
from exo_sim.diagnosis.outcome.rig_update import rig_update
from exo_sim.diagnosis.outcome.sensor_faults import faulty_scales, faulty_zeros
from exo_sim.diagnosis.outcome.small_findings import small_findings
from exo_sim.diagnosis.outcome.untested_balances import untested_balances
from exo_sim.diagnosis.outcome.verdict import distinct, next_experiment, swings_astray, verdict_of
from exo_sim.diagnosis.outcome.wrong_sizes import advice, suspected_bores
from exo_sim.diagnosis.pipeline.freed_memory import return_freed, return_large_arrays
from exo_sim.diagnosis.pipeline.machine_fit import fitted_to_machine
from exo_sim.diagnosis.pipeline.machine_needs import with_what_the_machine_needs
from exo_sim.diagnosis.pipeline.motion_stage import undecided
from exo_sim.diagnosis.pipeline.plan import Examination, Progress
from exo_sim.diagnosis.pipeline.rate_questions import hidden_by_rate
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.pipeline.rig_acceptance import accepted, likelier
from exo_sim.diagnosis.pipeline.rounds import examine_until_stable, with_test_findings, without_doubtful, without_small
from exo_sim.diagnosis.pipeline.shared_supply import with_supply_put_right
from exo_sim.diagnosis.policy.budgets import MOST_REJECTED
from exo_sim.diagnosis.result import Diagnosis, Verdict
from exo_sim.diagnosis.selection.nuisance_calibration import calibration_findings
from exo_sim.linear_algebra import in_one_thread
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.reader import Reading
from exo_sim.rig import Rig

_TOGETHER = (
    "numbers of improved.toml were fitted once more together to motion and gas at once, each within its 95 %: by less than that they "
    "differ from those of the findings"
)
_STOPPED = "the time that was given was up before everything had been sought: this is the best answer until then"


@in_one_thread
def diagnose(
    recordings: Sequence[Path | Reading],
    rig: Path | Rig,
    *,
    column_map: Path | ColumnMap | None = None,
    seed: int = 0,
    jobs: int | None = None,
    progress: Progress | None = None,
    folder: Path | None = None,
    budget: float = math.inf,
) -> Diagnosis:
    """Hold recordings of one machine against its rig and say what the rig leaves out.

    Args:
        recordings: Files of the contract, or what was read of them; several are one case with shared parameters.
        rig: The nominal rig, as its owner describes the machine.
        column_map: Names of foreign columns.
        seed: Kept for the contract: nothing here is drawn by chance.
        jobs: Threads; every core when absent. The answer does not depend on it.
        progress: Called with a few words on what is going on.
        folder: Where `improved.toml` will be, so that it finds its MJCF.
        budget: Time after which the best answer so far comes [s]: fits and searches end where they are, each stage at its share. An
            answer that it ended early depends on the machine's speed.

    Raises:
        RecordingError, RigError, ModelError: one line each.
    """
    report, allowed = progress or (lambda words: None), Budget(budget)
    report("reading")
    return_large_arrays()
    data = gather(recordings, rig, column_map)
    return_freed()  # what filters of its columns took
    data.rig.check_no_recovery("a recording")
    with Threads(jobs or os.cpu_count() or 1) as threads:  # what is reported of rivals is fitted as well
        stable = examine_until_stable(data, threads, report, allowed)
        stable, left = with_supply_put_right(stable, threads, report, allowed, data)
        left.stopped |= allowed.stopped
        answer = _reported(stable, left, report, folder, threads)
    return_freed()
    return answer


def _reported(stable: Examination, allowed: Budget, report: Progress, folder: Path | None, threads: Threads) -> Diagnosis:
    """Return what an examination says, and the improved rig as far as it wins."""
    allowed.allow_until(1.0)
    whole = without_doubtful(stable)
    needed = with_what_the_machine_needs(whole, without_small(whole), allowed.is_spent)
    found, in_the_test = with_test_findings(needed)
    findings = [*_findings(found), *in_the_test]
    data, results, test, split = found.data, found.results, found.test, found.plan.split
    report("writing the rig anew")
    update = rig_update(data, results.all, found.unknown)
    update = likelier(data, update, with_constant_force(update, results.motion), split, allowed.is_spent)
    report("fitting its numbers to the whole machine")
    return_freed()
    fitted = fitted_to_machine(data, update, split, threads, allowed.is_spent)
    report("running it")
    return_freed()
    kept, said = accepted(data, update, split, allowed.is_spent, fitted)
    is_changed = kept.update is not update
    return_freed()  # what its runs took
    without_noise = computed_columns.computed(data.recordings, list(dict.fromkeys([*test.signals, *kept.free_run])))
    noise_said = [computed_columns.remark(without_noise)] if without_noise else []
    together = [_TOGETHER] if kept.update.is_fitted_together and kept.update.parts else []
    untested = untested_balances(results.all, test.balances, test.influence)
    remarks = (*data.remarks, *said, *together, *untested, *noise_said, *([_STOPPED] if allowed.stopped else []))
    by_chance = tuple(kept.by_chance())
    small = (*found.small, *small_findings(results.all, [*findings, *found.small]))
    judged = {one.model.kind for one in results.all if not one.is_empty and not one.is_unresolved}
    verdict = verdict_of(findings, judged, data)
    astray = swings_astray(data, kept.free_run) if verdict in (Verdict.CONSISTENT, Verdict.CALIBRATION) else ()
    questions = distinct((*data.open_questions, *astray, *undecided(results.motion), *hidden_by_rate(data, results.gas)))
    return Diagnosis(
        verdict=Verdict.UNDETERMINED if astray else verdict,
        recordings=tuple(table.name for table in data.recordings),
        rig=data.rig.name,
        located=located([one for one in results.all if one.findings or one.has_unknown]),
        effects=tuple(findings),
        rejected=_rejected(found, [*findings, *small]),
        signals={**test.signals, **{key: fit for key, fit in kept.windows.items() if is_changed and key in test.signals}},
        free_run=kept.free_run,
        held_out=split.test,
        unexplained=unexplained(results.all, found.unknown),
        small=small,
        next_experiment=next_experiment(findings, questions, results.all),
        open_questions=questions,
        sensor_remarks=tuple(dict.fromkeys(remarks)),
        computed=without_noise,
        by_chance=by_chance,
        sizes=_sizes(findings, {key: fit for key, fit in kept.free_run.items() if key not in by_chance}, data),
        checks=tuple(check.as_dict() for check in data.checks),
        series=test.series,
        improved=kept.update.text(folder or data.rig.path.parent),
        improves=bool(kept.update.parts),
        tables=data.as_read,
        stopped=allowed.stopped,
    )


def _sizes(findings: Sequence[Finding], free_run: Mapping[str, SignalFit], data: MachineData) -> str:
    """Return which sizes of the rig are to be checked first, and why."""
    sliding = {link.cylinder: link.joint for link in data.links if not link.turning}
    levers = {link.cylinder for link in data.links if link.turning}
    return advice(findings, free_run, suspected_bores(findings, data.rig, sliding), data.rig, levers)


def _findings(found: Examination) -> list[Finding]:
    """Return what was found: physics with or without a name by what it costs the machine's predictions, then sensors, then numbers."""
    drops, costs, shares, results = found.test.drops, found.test.costs, found.shares, found.results.all
    findings = list({f.at: f for f in reversed(found.data.sensors)}.values())[::-1]  # of several recordings, once
    doubtful = {one.where for one in found.results.gas if one.has_unknown}
    for one in results:
        for f in one.findings:
            probability = confidence(f, shares.get(f.key), f.where in doubtful, f.at in found.plan.upheld)
            proved = replace(f, held_out_error_drop=drops.get(f.key, 0.0), cost=costs.get(f.key, 0.0), probability=probability)
            findings += proved.at_each_place()
    findings += faulty_zeros(results, findings)
    findings += faulty_scales(results, findings)
    for one in results:
        findings += calibration_findings(one.deviations)
    unknown = (effect.finding for effect in found.unknown)
    findings += [replace(f, held_out_error_drop=drops.get(f.where, 0.0), cost=costs.get(f.where, 0.0)) for f in unknown]
    return in_order(findings)


def _rejected(found: Examination, findings: Sequence[Finding]) -> tuple[Rejected, ...]:
    """Return what was refuted by validation and what was rejected before, without what is said already: a finding, small, or a rival."""
    taken = {at for f in findings for at in (f.at, *((name, f.where) for name in f.ambiguous_with))}
    refuted = [Rejected(name, where, why) for (name, where), why in found.plan.refuted.items()]
    rejected = [*refuted, *(r for one in found.results.all for r in one.rejected)]
    return tuple(r for r in rejected if (r.name, r.where) not in taken)[:MOST_REJECTED]
