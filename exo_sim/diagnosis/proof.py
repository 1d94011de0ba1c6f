"""The proof on time and recordings that took no part: errors before and after, and what each finding is worth there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from exo_sim.diagnosis.cases import Case
from exo_sim.diagnosis.fitted_set import Trial
from exo_sim.diagnosis.gas_problem import GasProblem
from exo_sim.diagnosis.intervals import normalised
from exo_sim.diagnosis.judging import Judged, finite
from exo_sim.diagnosis.motion_cut import as_smooth
from exo_sim.diagnosis.motion_problem import MotionProblem
from exo_sim.diagnosis.quantity import Setting
from exo_sim.diagnosis.result import Series, SignalFit
from exo_sim.diagnosis.split import Split
from exo_sim.diagnosis.supply_cut import SupplyProblem
from exo_sim.diagnosis.unknown import hats
from exo_sim.diagnosis.verdict import Unnamed, setting_of
from exo_sim.diagnosis.weighing import correlation_time
from exo_sim.physics.effects.unknown import ACTS, DEPENDS_ON, KNOTS

#: Predictions whose error is reported run over this time [s].
WINDOW = 0.5
#: A name that lowers the error of the check by less than this share needs odds above these (log10) to stand ...
LEAST_DROP, PLAIN_ODDS = 0.15, 25.0
#: ... and one that raises it by more than this, above these.
MOST_RISE, GREAT_ODDS = 0.1, 100.0


@dataclass(frozen=True)
class Missed:
    """By how much one balance is missed on held-out time.

    Attributes:
        error: Of the balance, in units of the noise.
        fitted: What the fit leaves of it, in the same units.
        most: The largest that a healthy machine's is.
        log10_odds: That it is more than noise.
    """

    error: float
    fitted: float
    most: float
    log10_odds: float

    @property
    def ratio(self) -> float:
        """The error in units of what the fit leaves, or of the noise; 0 where it is no number."""
        return finite(self.error / max(self.fitted, 1.0))

    def is_sick(self, times: float = 1.0) -> bool:
        """Say whether the error is more than so many times any healthy machine's."""
        return self.error > times * self.most

    def is_newly_sick(self, times: float = 1.0) -> bool:
        """Say whether it is, and that of the fit is not."""
        return self.is_sick(times) and self.fitted < self.most


@dataclass
class Proof:
    """Errors on held-out time.

    Attributes:
        signals: By column, before and after.
        drops: By `effect@where` (by place for what has no name), the share by which the held-out error falls.
        series: What a report draws.
        held_out, held_out_recordings: Which time was kept.
        felt: By the keys of `drops`, how much predictions change with it [units of the noise].
        missed: By cut and place.
        surprise: The largest error of a balance, in units of what the fit leaves of it, or of the noise.
    """

    signals: dict[str, SignalFit] = field(default_factory=dict)
    drops: dict[str, float] = field(default_factory=dict)
    series: tuple[Series, ...] = ()
    held_out: tuple[tuple[float, float], ...] = ()
    held_out_recordings: tuple[str, ...] = ()
    felt: dict[str, float] = field(default_factory=dict)
    missed: dict[tuple[str, str], Missed] = field(default_factory=dict)
    surprise: float = 0.0


def prove(judged: Sequence[Judged], case: Case, parts: Split, nameless: Sequence[Unnamed]) -> Proof:
    """Predict the time that was kept, with the rig as believed and as it was found to be."""
    proof = Proof()
    series: list[Series] = []
    for one in judged:
        if one.empty:
            continue
        curve = next((u for u in nameless if u.judged is one), None)
        if isinstance(one.problem, GasProblem):
            series += _gas(one, case, parts, curve, proof)
        elif isinstance(one.problem, SupplyProblem):
            series += _supply(one, parts, proof)
        else:
            series += _motion(one, case, parts, curve, proof)
    proof.series = tuple(series)
    spans = {name: kept for name, kept in parts.spans.items()}
    first = next(iter(spans), None)
    proof.held_out = spans[first] if first else ()
    if len(case.recordings) > 1:
        proof.held_out_recordings = tuple(spans)
    return proof


def doubtful(drop: float, log10_odds: float) -> bool:
    """Say whether the check speaks against a name: its error hardly falls with it, and the odds were not great."""
    return (drop < LEAST_DROP and log10_odds < PLAIN_ODDS) or (drop < -MOST_RISE and log10_odds < GREAT_ODDS)


def _settings(one: Judged, curve: Unnamed | None) -> tuple[Setting, Setting]:
    """Return the machine as believed, and as found."""
    assert isinstance(one.problem, GasProblem | MotionProblem)
    after = setting_of(one, one.trial)
    if curve is not None and isinstance(one.problem, GasProblem):
        _put_curve(after, curve)
    return one.problem.setting, after


def _put_curve(setting: Setting, unnamed: Unnamed) -> None:
    best = unnamed.nameless.best
    if best is None or best.variable not in DEPENDS_ON:
        return
    record = setting.cylinder["unknown"]
    record["acts"], record["depends_on"] = ACTS.index(unnamed.nameless.acts), DEPENDS_ON.index(best.variable)
    count = len(best.at)
    tail = best.at[-1] + 1e-6 * (1.0 + np.arange(KNOTS - count)) * max(abs(best.at[-1]), 1.0)
    record["at"][0] = np.concatenate([best.at, tail])
    record["values"][0] = np.concatenate([best.values, np.full(KNOTS - count, best.values[-1])])


def _gas(one: Judged, case: Case, parts: Split, curve: Unnamed | None, proof: Proof) -> list[Series]:
    assert isinstance(one.problem, GasProblem)
    runs = case.cylinders[one.where]
    believed, found = _settings(one, curve)
    kept = GasProblem(runs, one.problem.setting, parts, WINDOW, held_out=True)
    before = [kept.predict(believed, index, whole=False).pressure for index in range(len(runs))]
    after = [kept.predict(found, index, whole=False).pressure for index in range(len(runs))]
    series = []
    for side in range(2):
        errors: tuple[list[np.ndarray], list[np.ndarray]] = ([], [])
        noise = 0.0
        for index, run in enumerate(runs):
            measured = run.pressure[side]
            if measured is None:
                continue
            noise = max(noise, run.noise[side])
            mask = parts.held_out(run.recording, run.time)
            errors[0].append((measured - before[index][:, side])[mask])
            errors[1].append((measured - after[index][:, side])[mask])
            series.append(
                Series(run.recording, f"{one.where}.pressure_{side + 1}", "Pa", run.time, measured, before[index][:, side],
                       after[index][:, side], run.noise[side])
            )  # fmt: skip
        if errors[0] and sum(e.size for e in errors[0]):
            proof.signals[f"{one.where}.pressure_{side + 1}"] = SignalFit(
                "Pa",
                finite(normalised(np.concatenate(errors[0]))),
                finite(normalised(np.concatenate(errors[1]))),
                noise,
            )
    _drops(one, kept, found, believed, curve, proof)
    return series


def _motion(one: Judged, case: Case, parts: Split, curve: Unnamed | None, proof: Proof) -> list[Series]:
    assert isinstance(one.problem, MotionProblem)
    runs = one.problem.runs
    believed, found = _settings(one, curve)
    kept = MotionProblem(runs, one.problem.setting, parts, held_out=True)
    series = []
    errors: tuple[list[np.ndarray], list[np.ndarray]] = ([], [])
    for index, run in enumerate(runs):
        group = kept._groups[index]
        before, after = kept.missing(believed, index), kept.missing(found, index)
        if curve is not None and curve.nameless.best is not None:
            best = curve.nameless.best
            values = {"position": run.position, "velocity": run.velocity, "time": run.time - run.time[0]}
            if run.cylinder is not None:
                values |= {
                    "pressure_1": run.gauge[:, 0],
                    "pressure_2": run.gauge[:, 1],
                    "pressure_difference": run.gauge[:, 0] - run.gauge[:, 1],
                }
            if best.variable in values:
                after = after - as_smooth(run.time, run.arm * (hats(values[best.variable], best.at) @ best.values))
        needed = run.inertial - run.passive
        quiet = np.where(np.abs(run.velocity) > run.still, 1.0, np.nan)
        series.append(
            Series(run.recording, f"{one.where}.force_balance", kept.unit, run.time, needed * quiet, (needed - before) * quiet,
                   (needed - after) * quiet, float(np.median(kept.scale)) if kept.scale.size else run.noise)
        )  # fmt: skip
        errors[0].append(before[group >= 0])
        errors[1].append(after[group >= 0])
    if sum(e.size for e in errors[0]):
        proof.signals[f"{one.where}.force_balance"] = SignalFit(
            kept.unit, finite(normalised(np.concatenate(errors[0]))), finite(normalised(np.concatenate(errors[1]))),
            float(np.median(kept.scale)) if kept.scale.size else 0.0,
        )  # fmt: skip
    _drops(one, kept, found, believed, curve, proof)
    return series


def _supply(one: Judged, parts: Split, proof: Proof) -> list[Series]:
    assert isinstance(one.problem, SupplyProblem)
    found = setting_of(one, one.trial)
    kept = SupplyProblem(one.problem.runs, one.problem.setting, parts, held_out=True)
    series, errors = [], ([], [])  # type: ignore[var-annotated]
    for index, run in enumerate(kept.runs):
        before, after = kept.predict(one.problem.setting, index), kept.predict(found, index)
        mask = kept.group[index] >= 0
        errors[0].append((run.pressure - before)[mask])
        errors[1].append((run.pressure - after)[mask])
        series.append(Series(run.recording, "supply.pressure", "Pa", run.time, run.pressure, before, after, run.noise))
    if kept.size:
        proof.signals["supply.pressure"] = SignalFit(
            "Pa", finite(normalised(np.concatenate(errors[0]))), finite(normalised(np.concatenate(errors[1]))),
            max(run.noise for run in kept.runs),
        )  # fmt: skip
    _drops(one, kept, found, one.problem.setting, None, proof)
    return series


def _drops(
    one: Judged,
    kept: GasProblem | MotionProblem | SupplyProblem,
    found: Setting,
    believed: Setting,
    curve: Unnamed | None,
    proof: Proof,
) -> None:
    """Say by what share the held-out error grows when one finding is left out and everything else refitted without it."""
    if kept.size == 0:
        return
    residual = _residual(kept, found)
    whole = normalised(residual)
    alike = max(correlation_time(residual, kept.blocks), 1.0)
    odds = 0.5 * kept.size / alike * math.log10(max(whole, 1.0) ** 2)
    missed = Missed(whole, normalised(one.trial.fit.residual), kept.sick, odds)
    proof.missed[one.cut, one.where] = missed
    proof.surprise = max(proof.surprise, missed.ratio)
    told = {(finding.name, finding.where) for finding in one.findings}
    for candidate in (candidate for candidate in one.named if (candidate.effect, candidate.where) in told):
        rest = tuple(c for c in one.trial.chosen if c.key != candidate.key)
        without: Trial = one.sets.try_set(rest, one.trial)
        other = _residual(kept, setting_of(one, without))
        lacking, name = normalised(other), f"{candidate.effect}@{candidate.where}"
        proof.drops[name] = finite(1.0 - whole / lacking) if lacking > 0.0 else 0.0
        proof.felt[name] = finite(normalised(other - residual))
    if curve is not None:
        plain = normalised(_residual(kept, setting_of(one, one.trial)))
        key = next(
            (
                k
                for k in proof.signals
                if k.startswith(one.where) and (k.endswith("force_balance") == (one.cut == "motion"))
            ),
            None,
        )
        if one.cut == "motion" and key:
            signal = proof.signals[key]
            proof.drops[one.where] = finite(1.0 - signal.after / signal.before) if signal.before > 0.0 else 0.0
        else:
            proof.drops[one.where] = finite(1.0 - whole / plain) if plain > 0.0 else 0.0


def _residual(problem: GasProblem | MotionProblem | SupplyProblem, setting: Setting) -> np.ndarray:
    return problem.residual_of(setting)
