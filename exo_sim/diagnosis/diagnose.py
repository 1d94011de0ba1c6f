"""The diagnosis from end to end: read, cut, search, judge, prove, and write the rig anew."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from exo_sim.diagnosis import library, motion_problem, supply_cut
from exo_sim.diagnosis.cases import Case, gather, put_right, turned_round
from exo_sim.diagnosis.chamber_pressure import carried_over
from exo_sim.diagnosis.gas_problem import GasProblem
from exo_sim.diagnosis.judging import Judged, calibration_findings, judge
from exo_sim.diagnosis.motion_problem import MotionProblem
from exo_sim.diagnosis.nameless import pattern_left
from exo_sim.diagnosis.proof import Proof, doubtful, prove
from exo_sim.diagnosis.quantity import Candidate, Setting
from exo_sim.diagnosis.result import Diagnosis, Finding, Located, Rejected
from exo_sim.diagnosis.rewriting import improved_text
from exo_sim.diagnosis.search import Search
from exo_sim.diagnosis.split import Split, split
from exo_sim.diagnosis.verdict import (
    Unnamed,
    located,
    next_experiment,
    open_questions,
    setting_of,
    unexplained,
    unknown_findings,
    verdict_of,
)
from exo_sim.physics.records import CYLINDER
from exo_sim.rig import assembly

#: A valve command whose opposite leaves less than this share of the squared error is wired the wrong way round.
TURNED = 0.1

#: Where time kept back is missed by so many times what the rest leaves, it shows something that the rest never met.
SURPRISE = 3.0

#: So few samples cost little to predict: every question is then fitted whole.
FEW_SAMPLES = 5000

#: How often a case is examined again without what time kept back did not bear out.
MOST_DOUBTS = 4

Progress = Callable[[str], None]
#: Effect and place that time kept back does not bear out, and why.
Doubts = dict[tuple[str, str], str]


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
    with ThreadPoolExecutor(jobs or os.cpu_count() or 1) as pool:
        examined = _proven(gathered, False, pool, say)
        if examined.proof.surprise > SURPRISE:
            say("what was kept back shows what the rest never met: roles are exchanged")
            examined = min(examined, _proven(gathered, True, pool, say), key=lambda one: one.proof.surprise)
    case, judged, nameless, proof = examined.case, examined.judged, examined.nameless, examined.proof
    findings = _findings(judged, case, proof.drops)
    findings += [replace(found.finding, held_out_error_drop=proof.drops.get(found.finding.where, 0.0)) for found in nameless]
    say("writing the rig anew")
    text = improved_text(case, judged, nameless, folder or rig.parent)
    return Diagnosis(
        verdict=verdict_of(findings, judged, case),
        recordings=tuple(table.name for table in case.recordings),
        rig=case.rig.name,
        located=_placed(judged),
        effects=tuple(findings),
        rejected=_rejections(judged, findings, examined.doubted),
        signals=proof.signals,
        held_out=proof.held_out,
        held_out_recordings=proof.held_out_recordings,
        unexplained=unexplained(judged, nameless),
        next_experiment=next_experiment(findings, judged, case),
        open_questions=open_questions(case),
        sensor_remarks=tuple(dict.fromkeys(case.remarks)),
        series=proof.series,
        improved=text,
    )


@dataclass
class _Examined:
    """What came out while one part of the time was kept back."""

    case: Case
    judged: list[Judged]
    nameless: list[Unnamed]
    proof: Proof
    doubted: Doubts


def _proven(gathered: Case, head: bool, pool: ThreadPoolExecutor, say: Progress) -> _Examined:
    """Examine a case, and again without what time kept back does not bear out."""
    doubted: Doubts = {}
    for _ in range(MOST_DOUBTS):
        examined = _examined(gathered.copy(), head, doubted, pool, say)
        new = {
            (finding.name, finding.where): f"on time kept back the error falls by no more than {100 * max(drop, 0.0):.0f} % with it"
            for one in examined.judged
            for finding in one.findings
            if doubtful(drop := examined.proof.drops.get(f"{finding.name}@{finding.where}", 0.0), finding.log10_odds)
        }
        if not new:
            break
        doubted = {**doubted, **new}
    return examined


def _examined(case: Case, head: bool, doubted: Doubts, pool: ThreadPoolExecutor, say: Progress) -> _Examined:
    parts = split([(table.name, table.time) for table in case.recordings], head)
    gas = _gas(case, parts, doubted, pool, say)
    put_right(case, carried_over(case, gas, parts))
    judged = _shared_once([*gas, *_supply(case, parts, gas, doubted, say), *_motion(case, parts, doubted, say)])
    nameless = unknown_findings(_rigid(judged))
    say("proving on time kept back")
    return _Examined(case, judged, nameless, prove(judged, case, parts, nameless), doubted)


def _asked(questions: Sequence[Candidate], doubted: Doubts) -> tuple[Candidate, ...]:
    """Return the questions that time kept back has not answered with no."""
    return tuple(question for question in questions if (question.effect, question.where) not in doubted)


def _told(say: Progress, part: str) -> Progress:
    """Return a progress that names the part it speaks of."""
    return lambda words: say(f"{part}: {words}")


def _gas(case: Case, parts: Split, doubted: Doubts, pool: ThreadPoolExecutor, say: Progress) -> list[Judged]:
    found = []
    for name, runs in case.cylinders.items():
        joint = next(link.joint for link in case.links if link.cylinder == name)
        index = list(case.rig.cylinders).index(name)
        setting = Setting(assembly.world(case.rig), assembly.cylinders(case.rig)[index : index + 1])
        problem = GasProblem(runs, setting, parts)
        turned = GasProblem([replace(run, command=-run.command) for run in runs], setting, parts)
        if problem.size >= 30 and np.sum(turned.residual({}) ** 2) < TURNED * np.sum(problem.residual({}) ** 2):
            problem, case.cylinders[name] = turned, turned.all_runs
            case.sensors.append(turned_round(name))
        commanded = any(run.commanded for run in runs)
        sides = [side for side in (1, 2) if any(run.pressure[side - 1] is not None for run in runs)]
        still = all(run.rests for run in runs)
        nuisances = library.believed(setting, name, commanded, sides, still) + library.known_effects(setting, name)
        questions = library.candidates(setting, runs, name, joint)
        if problem.size >= 30:
            problem = problem.either_law(nuisances, pool)
        search = Search(
            problem,
            nuisances,
            _asked(questions, doubted),
            pool,
            _told(say, name),
            cheap=sum(len(run.time) for run in runs) < FEW_SAMPLES,
            material=problem.material,
        )
        found.append(judge("gas", name, problem, search, search.run(), partial(pattern_left, problem)))
    return found


def _supply(case: Case, parts: Split, gas: Sequence[Judged], doubted: Doubts, say: Progress) -> list[Judged]:
    """Judge the measured supply by what all cylinders together drew from it; nothing where one of them is not known."""
    if len(gas) < len(case.rig.cylinders) or any(one.empty for one in gas):
        return []
    drawn: dict[str, np.ndarray] = {}
    measured: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    for one in gas:
        whole = GasProblem(case.cylinders[one.where], setting_of(one, one.trial), parts, held_out=True)
        for index, run in enumerate(whole.runs):
            if run.supply is not None and "supply.pressure" in (table := case.table(run.recording)):
                drawn[run.recording] = drawn.get(run.recording, 0.0) + whole.predict(whole.setting, index).drawn
                measured[run.recording] = (run.time, table["supply.pressure"])
    if not drawn:
        return []
    setting = Setting(assembly.world(case.rig), assembly.cylinders(case.rig)[:1])
    runs = [supply_cut.supply_run(name, *measured[name], drawn[name]) for name in drawn]
    problem = supply_cut.SupplyProblem(runs, setting, parts)
    search = Search(
        problem,
        supply_cut.believed(setting),
        _asked(supply_cut.candidates(setting), doubted),
        None,
        _told(say, "supply"),
        cheap=True,
        material=problem.material,
    )
    return [judge("supply", "supply", problem, search, search.run(), partial(pattern_left, problem))]


def _motion(case: Case, parts: Split, doubted: Doubts, say: Progress) -> list[Judged]:
    found = []
    for joint, runs in case.joints.items():
        cylinder = runs[0].cylinder
        if cylinder is not None:
            index = list(case.rig.cylinders).index(cylinder)
            record = assembly.cylinders(case.rig)[index : index + 1]
            _carry_over(case, joint, record)
        else:
            record = np.zeros(1, CYLINDER)
            _carry_over(case, joint, record)
        where = cylinder or joint
        setting = Setting(assembly.world(case.rig), record)
        problem = MotionProblem(runs, setting, parts)
        nuisances = motion_problem.believed(runs, setting, where)
        questions = motion_problem.candidates(runs, problem.setting, where)
        search = Search(
            problem,
            nuisances,
            _asked(questions, doubted),
            None,
            _told(say, joint),
            cheap=True,
            material=problem.material,
        )
        found.append(judge("motion", where, problem, search, search.run(), partial(pattern_left, problem)))
    return found


def _rigid(judged: list[Judged]) -> list[Judged]:
    """Take back what has no name in a balance of forces whose transmission was found to give: the balance takes it for rigid."""
    soft = {f.where for one in judged for f in one.findings if f.name in ("backlash", "transmission_compliance")}
    for one in judged:
        if one.cut == "motion" and one.where in soft:
            one.nameless = False
    return judged


def _carry_over(case: Case, joint: str, record: np.ndarray) -> None:
    """Put what the rig says of the joint's own friction and springs into the record that the balance is judged with."""
    for effect in case.rig.effects:
        if effect.where == joint and effect.name in (record.dtype.names or ()):
            for name, value in effect.parameters.items():
                record[effect.name][name] = value


def _shared_once(judged: list[Judged]) -> list[Judged]:
    """Keep an effect of the shared supply or exhaust where it is seen best, and only there."""
    best: dict[tuple[str, str], tuple[float, int]] = {}
    for index, one in enumerate(judged):
        for finding in one.findings:
            key = finding.name, finding.where
            if key not in best or finding.log10_odds > best[key][0]:
                best[key] = finding.log10_odds, index
    for index, one in enumerate(judged):
        one.findings[:] = [f for f in one.findings if best[f.name, f.where][1] == index]
    return judged


def _findings(judged: list[Judged], case: Case, drops: dict[str, float]) -> list[Finding]:
    findings = list(case.sensors)
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

