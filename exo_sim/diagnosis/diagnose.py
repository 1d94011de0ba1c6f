"""The diagnosis from end to end: read, examine, check, and say what was found."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from exo_sim.diagnosis.calibrations import calibration_findings
from exo_sim.diagnosis.cases import Case, gather
from exo_sim.diagnosis.checking import examined_and_checked, unmet
from exo_sim.diagnosis.examining import Doubts, Progress
from exo_sim.diagnosis.free_run import free_runs
from exo_sim.diagnosis.judging import Judged
from exo_sim.diagnosis.result import Diagnosis, Finding, Located, Rejected
from exo_sim.diagnosis.rewriting import improved_text
from exo_sim.diagnosis.threads import Threads
from exo_sim.diagnosis.verdict import located, next_experiment, open_questions, unexplained, verdict_of


def diagnose(
    recordings: Sequence[Path],
    rig: Path,
    *,
    column_map: Path | None = None,
    seed: int = 0,
    jobs: int | None = None,
    progress: Progress | None = None,
    folder: Path | None = None,
) -> Diagnosis:
    """Hold recordings of one machine against its rig and say what the rig leaves out.

    Args:
        recordings: Files of the contract; several are one case with shared parameters.
        rig: The rig as its owner believes it to be.
        column_map: Names of foreign columns.
        seed: Kept for the contract: nothing here is drawn by chance.
        jobs: Threads; every core when absent. The answer does not depend on it.
        progress: Told in a few words what is going on.
        folder: Where `improved.toml` will lie, so that it finds its MJCF.

    Raises:
        RecordingError, RigError, ModelError: one line each.
    """
    say = progress or (lambda words: None)
    say("reading")
    gathered = gather(recordings, rig, column_map)
    with Threads(jobs or os.cpu_count() or 1) as threads:
        examined = examined_and_checked(gathered, threads, say)
    case, judged, nameless, proof = examined.case, examined.judged, examined.nameless, examined.proof
    findings = _findings(judged, case, proof.drops)
    findings += [replace(found.finding, held_out_error_drop=proof.drops.get(found.finding.where, 0.0)) for found in nameless]
    findings += unmet(examined)
    say("writing the rig anew")
    text = improved_text(case, judged, nameless, folder or rig.parent)
    say("running it")
    runs = free_runs(case, improved_text(case, judged, nameless, rig.parent), examined.parts.spans)
    return Diagnosis(
        verdict=verdict_of(findings, judged, case),
        recordings=tuple(table.name for table in case.recordings),
        rig=case.rig.name,
        located=_placed(judged),
        effects=tuple(findings),
        rejected=_rejections(judged, findings, examined.doubted),
        signals=proof.signals,
        free_run=runs,
        held_out=proof.held_out,
        held_out_recordings=proof.held_out_recordings,
        unexplained=unexplained(judged, nameless),
        next_experiment=next_experiment(findings, judged, case),
        open_questions=open_questions(case),
        sensor_remarks=tuple(dict.fromkeys(case.remarks)),
        series=proof.series,
        improved=text,
    )


def _findings(judged: list[Judged], case: Case, drops: dict[str, float]) -> list[Finding]:
    findings = list({(f.name, f.where): f for f in reversed(case.sensors)}.values())[::-1]  # of several recordings, once
    for one in judged:
        findings += [replace(f, held_out_error_drop=drops.get(f"{f.name}@{f.where}", 0.0)) for f in one.findings]
    for one in judged:
        findings += calibration_findings(one.calibrations)
    order = {"missing_physics": 0, "unknown": 1, "sensor": 2, "calibration": 3}
    return sorted(findings, key=lambda f: (order[f.kind], -f.log10_odds))


def _placed(judged: list[Judged]) -> tuple[Located, ...]:
    return located([one for one in judged if one.findings or one.nameless])


def _rejections(judged: list[Judged], findings: list[Finding], doubted: Doubts) -> tuple[Rejected, ...]:
    taken = {(f.name, f.where) for f in findings}
    first = [Rejected(name, where, why) for (name, where), why in doubted.items()]
    return tuple(r for r in [*first, *(r for one in judged for r in one.rejected)] if (r.name, r.where) not in taken)[:20]
