"""The verdict, and what to record next."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.findings import Finding, Kind, NextExperiment, OpenQuestion, Subsystem, Verdict
from exo_sim.physics.effects.unknown import EFFECT as UNKNOWN


def verdict_of(findings: Sequence[Finding], judged: Collection[Subsystem], data: MachineData) -> Verdict:
    """Return the verdict: physics or a sensor at fault, numbers off, all well, or nobody can tell.

    Args:
        findings: All of them.
        judged: The kinds of subsystem of which one was judged to the end.
        data: The machine.
    """
    if any(f.kind is not Kind.CALIBRATION for f in findings):
        return Verdict.MISMATCH
    free = any(int(kind) in (0, 1) for kind in data.model.jnt_type) or data.model.njnt > len(data.rig.cylinders) + 1
    driven = bool(data.externally_driven) and not any(link.joint not in data.externally_driven for link in data.links)
    wanted = {Subsystem.MOTION}
    if data.rig.cylinders:
        wanted = {Subsystem.GAS} if free or driven else {Subsystem.GAS, Subsystem.MOTION}
    if not wanted <= set(judged):
        return Verdict.UNDETERMINED
    return Verdict.CALIBRATION if findings else Verdict.CONSISTENT


def distinct(questions: Sequence[OpenQuestion]) -> tuple[OpenQuestion, ...]:
    """Return each open question once."""
    return tuple({(q.question, q.why): q for q in questions}.values())


def next_experiment(findings: Sequence[Finding], questions: Sequence[OpenQuestion]) -> NextExperiment | None:
    """Return what to record next: to separate effects that look the same, to see a curve, or to answer an open question."""
    for finding in findings:
        if finding.ambiguous_with:
            rival = finding.ambiguous_with[0]
            why = f"{wording.name_of(finding.name)} and {wording.name_of(rival)} explain this recording equally well"
            return NextExperiment(why, wording.experiment(finding.name, rival), (finding.name, *finding.ambiguous_with))
    for finding in findings:
        if finding.kind is Kind.UNKNOWN:
            follows = finding.depends_on[0] if finding.depends_on else "one signal at a time"
            do = f"move {follows} alone, slowly and then fast, with the valve closed where that is possible"
            return NextExperiment("something is missing that has no name", do, (UNKNOWN.name,))
    for question in questions:
        return NextExperiment(
            f"{question.question} cannot be judged: {question.why}", "record that signal as well", question.effects
        )
    return None
