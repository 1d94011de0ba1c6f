"""From what the cuts say to one answer: where it sits, what has no name, what remains, what to record next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.cases import Case
from exo_sim.diagnosis.fitted_set import Trial
from exo_sim.diagnosis.gas_problem import STRUCTURAL_FLOOR, GasProblem
from exo_sim.diagnosis.judging import Judged
from exo_sim.diagnosis.locating import Trace, gas_regimes, loud_spans, motion_regimes, worst_regime
from exo_sim.diagnosis.motion_problem import MotionProblem
from exo_sim.diagnosis.nameless import Nameless, missing_flow, missing_force
from exo_sim.diagnosis.quantity import Setting
from exo_sim.diagnosis.result import Estimate, Finding, Located, NextExperiment, OpenQuestion, Unexplained
from exo_sim.diagnosis.supply_cut import SupplyProblem
from exo_sim.diagnosis.tremor import trembles


@dataclass(frozen=True)
class Unnamed:
    """A finding without a name, and the cut that it comes from."""

    finding: Finding
    nameless: Nameless
    judged: Judged


def setting_of(judged: Judged, trial: Trial) -> Setting:
    """Return the machine as a trial has it."""
    problem = judged.problem
    assert isinstance(problem, GasProblem | MotionProblem | SupplyProblem)
    return problem.apply(trial.fit.values, trial.fixed)


def traces(judged: Judged, trial: Trial) -> list[Trace]:
    """Return the error of each balance of a cut along every recording, under one trial."""
    setting = setting_of(judged, trial)
    problem = judged.problem
    found = []
    if isinstance(problem, GasProblem):
        k = float(setting.world["k"][0])
        for index, errors in enumerate(problem.errors(setting)):
            feed = problem.feeds[index]
            for side in range(2):
                if feed.run.pressure[side] is None:
                    continue
                noise = float(np.hypot(feed.run.noise[side], STRUCTURAL_FLOOR))
                regimes = gas_regimes(feed.run, side, feed.supply, feed.exhaust, k)
                where = f"{judged.where}/chamber_{side + 1}"
                found.append(
                    Trace(where, judged.balance, "Pa", feed.run.recording, feed.time, errors[:, side], noise, regimes)
                )
    elif isinstance(problem, MotionProblem):
        for index, run in enumerate(problem.runs):
            error = np.where(problem._groups[index] >= 0, problem.missing(setting, index), np.nan)
            scale = float(np.median(problem.scale)) if problem.scale.size else 1.0
            regimes = motion_regimes(run.velocity, run.time)
            found.append(
                Trace(judged.where, judged.balance, problem.unit, run.recording, run.time, error, scale, regimes)
            )
    elif isinstance(problem, SupplyProblem):
        for index, fed in enumerate(problem.runs):
            error = np.where(problem.group[index] >= 0, fed.pressure - problem.predict(setting, index), np.nan)
            noise = float(np.median(problem.scale)) if problem.scale.size else 1.0
            regimes = {"drawing": fed.drawn > 0.2 * float(fed.drawn.max()), "resting": fed.drawn <= 0.2 * float(fed.drawn.max())}
            found.append(Trace("supply", judged.balance, "Pa", fed.recording, fed.time, error, noise, regimes))
    return found


def located(judged: Sequence[Judged]) -> tuple[Located, ...]:
    """Return the balances in which the error above the noise sits, the largest share first."""
    every = [trace for one in judged for trace in traces(one, one.found.start)]
    total = sum(trace.excess for trace in every)
    places: dict[tuple[str, str], list[Trace]] = {}
    for trace in every:
        places.setdefault((trace.where, trace.equation), []).append(trace)
    found = []
    for (where, equation), here in places.items():
        share = sum(trace.excess for trace in here) / total if total > 0.0 else 0.0
        if share < 0.02:
            continue
        worst = max(here, key=lambda trace: trace.excess)
        good = worst.error[np.isfinite(worst.error)]
        found.append(
            Located(where, equation, share, loud_spans(worst), worst_regime(worst), float(np.sqrt(np.mean(good**2))), worst.noise,
                    worst.unit, worst.recording)
        )  # fmt: skip
    return tuple(sorted(found, key=lambda place: -place.share))


def unknown_findings(judged: Sequence[Judged]) -> list[Unnamed]:
    """Return a finding for every cut in which something is missing that has no name."""
    found = []
    for one in judged:
        if not one.nameless:
            continue
        setting, place, bursts = setting_of(one, one.trial), one.balance, False
        if isinstance(one.problem, MotionProblem):
            lacking = missing_force(one.problem, setting)
        elif isinstance(one.problem, SupplyProblem):
            lacking = Nameless("flow", "Pa", (), float(np.std(one.problem.residual_of(setting) * one.problem.scale)))
        else:
            assert isinstance(one.problem, GasProblem)
            loud = sorted(traces(one, one.trial), key=lambda trace: -trace.excess)
            side = int(loud[0].where[-1]) - 1
            lacking = missing_flow(one.problem, setting, side)
            place = f"{one.balance} of chamber {side + 1}"
            bursts = trembles(one.problem, one.trial)
        best = lacking.best
        variables = (_column(one, best.variable),) if best else ()
        says = f"Something without a name acts in the {place} of {one.where}"
        says += f"; it follows {variables[0]}." if variables else "; it follows none of the recorded signals closely."
        says += " It comes in fast bursts, as a pressure that rings does." if bursts else ""
        curve = None
        parameters = {"size": Estimate(lacking.size, lacking.unit, 0.0, 2.0 * lacking.size)}
        if best:
            curve = {
                "acts": lacking.acts, "variable": best.variable, "at": [float(v) for v in best.at], "unit": lacking.unit,
                "values": [float(v) for v in best.values], "band": [float(v) for v in best.band], "explains": round(best.explains, 3),
            }  # fmt: skip
        n = one.problem.size
        odds = (
            0.5
            * n
            / max(one.sets.correlation_time(one.trial.fit.residual), 1.0)
            * np.log(max(one.trial.fit.sse / n, 1.0))
            / np.log(10.0)
        )
        finding = Finding(
            "unknown", one.where, "unknown", says, parameters, float(odds), 0.0, depends_on=variables, curve=curve
        )
        found.append(Unnamed(finding, lacking, one))
    return found


def _column(judged: Judged, variable: str) -> str:
    if variable == "time":
        return "time"
    problem = judged.problem
    if isinstance(problem, MotionProblem) and variable in ("position", "velocity"):
        return f"{problem.runs[0].joint}.{variable}"
    return f"{judged.where}.{variable}"


def unexplained(judged: Sequence[Judged], nameless: Sequence[Unnamed]) -> tuple[Unexplained, ...]:
    """Return what the final model still misses, as a share of what there was to explain."""
    found = []
    for one in judged:
        if one.empty or not (one.named or one.nameless):
            continue
        n = one.problem.size
        left = max(one.trial.fit.sse - 1.2 * n, 0.0) / max(one.found.start.fit.sse - n, 1e-9)
        if left > 0.01:
            follows = next((u.finding.depends_on for u in nameless if u.judged is one), ())
            found.append(Unexplained(f"{one.where}/{one.balance}", follows, min(left, 1.0)))
    return tuple(found)


def verdict_of(findings: Sequence[Finding], judged: Sequence[Judged], case: Case) -> str:
    """Return the verdict: physics or a sensor at fault, numbers off, all well, or nobody can tell."""
    if any(f.kind in ("missing_physics", "unknown", "sensor") for f in findings):
        return "mismatch"
    cuts = {one.cut for one in judged if not one.empty and not one.unclosed}
    free = any(int(kind) in (0, 1) for kind in case.model.jnt_type) or case.model.njnt > len(case.rig.cylinders) + 1
    led = bool(case.led) and not any(link.joint not in case.led for link in case.links)
    wanted = {"motion"} if not case.rig.cylinders else ({"gas"} if free or led else {"gas", "motion"})
    if not wanted <= cuts:
        return "undetermined"
    return "calibration" if any(f.kind == "calibration" for f in findings) else "consistent"


def open_questions(case: Case) -> tuple[OpenQuestion, ...]:
    """Return the questions that stay open, each once."""
    return tuple({(q.question, q.why): q for q in case.open}.values())


def next_experiment(findings: Sequence[Finding], judged: Sequence[Judged], case: Case) -> NextExperiment | None:
    """Return what to record next: to split a class that cannot be told apart, to see a curve, or to close an open question."""
    for finding in findings:
        if finding.ambiguous_with:
            rival = finding.ambiguous_with[0]
            why = f"{wording.name_of(finding.name)} and {wording.name_of(rival)} explain this recording equally well"
            return NextExperiment(why, wording.experiment(finding.name, rival), (finding.name, *finding.ambiguous_with))
    for finding in findings:
        if finding.kind == "unknown":
            follows = finding.depends_on[0] if finding.depends_on else "one signal at a time"
            do = f"move {follows} alone, slowly and then fast, with the valve closed where that is possible"
            return NextExperiment("something is missing that has no name", do, ("unknown",))
    for question in case.open:
        return NextExperiment(
            f"{question.question} cannot be judged: {question.why}", "record that signal as well", question.effects
        )
    return None
