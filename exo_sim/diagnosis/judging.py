"""From a search over one cut to findings: names, numbers with intervals, rivals, calibrations, and the case without a name."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.calibrations import MODEL_SHARE, SURE, calibrated, refitted_besides, unseen
from exo_sim.diagnosis.fitted_set import Found, Problem, Trial, sizeable
from exo_sim.diagnosis.gas_problem import GasProblem
from exo_sim.diagnosis.intervals import bounds, spreads
from exo_sim.diagnosis.quantity import Candidate, Quantity, standing
from exo_sim.diagnosis.result import Estimate, Finding, Rejected
from exo_sim.diagnosis.set_fits import SetFits
from exo_sim.diagnosis.tremor import trembles
from exo_sim.physics.effects.declaration import declared

#: What each cut holds against each other.
BALANCES = {"gas": "energy balance", "motion": "force balance", "supply": "mass balance"}
#: A rival whose log-likelihood is lower by less than this explains the recording as well.
AS_GOOD = 3.0
#: Residual variance in units of the noise beyond which something is left, and what named effects must then explain.
LEFT_OVER, EXPLAINED = 1.8, 0.90
#: Between this and nine tenths, names stand unless what is left follows one signal by more than that share.
HALFWAY, PATTERN = 0.8, 0.25
#: Where more is left than the noise, a finding takes more than this share of what was there without it: else it is one shape of many.
LARGER_PART = 0.7
#: Without any finding a residual variance beyond this is no healthy machine's.
SICK = 5.0
#: ... and an error that is left of so many times what is no healthy machine's bears no name, whatever share was explained.
HOPELESS = 2.0
#: Odds (log10) beyond which a finding stands however vague its number.
PLAIN_ODDS = 30.0
#: A believed number that had to move by more than this many of its own spreads speaks for something missing.
STRAINED = 3.5
#: Two ways in which a supply that nobody measured gives way.
_TANK, _REGULATOR = _SUPPLIES = ("supply_droop", "supply_regulator")
#: The hose that is declared delays and does not ring: it is not named where its like does.
_HOSE = "line_restriction"
#: Ratio that stands for the paper's own nozzle.
_NOZZLE = (0.508, 0.548)


@dataclass
class Judged:
    """What one cut says.

    Attributes:
        cut: "gas", "motion" or "supply".
        where: The cylinder or joint.
        problem, sets, found: How it was found.
        named: Candidates that stand as findings.
        trial: The model that is believed in the end.
        nameless: True where something is missing that has no name.
        findings, calibrations, rejected: For the report.
        refitted: Believed numbers that a fit moved, though by no more than a data sheet allows, as far as the improved rig should say so.
        unclosed: True where what is left cannot be told from what an unmeasured chamber may do.
    """

    cut: str
    where: str
    problem: Problem
    sets: SetFits
    found: Found
    named: tuple[Candidate, ...]
    trial: Trial
    nameless: bool
    findings: list[Finding]
    calibrations: list[tuple[Quantity, float, float]]
    rejected: list[Rejected]
    unclosed: bool = False
    refitted: tuple[tuple[Quantity, float], ...] = ()

    @property
    def balance(self) -> str:
        """What the cut holds against each other, in words."""
        return BALANCES[self.cut]

    @property
    def empty(self) -> bool:
        """Whether there was nothing to judge."""
        return self.problem.size == 0 or self.trial.fit.residual.size == 0


def judge(
    cut: str, where: str, problem: Problem, sets: SetFits, found: Found, pattern: Callable[[Trial], float]
) -> Judged:
    """Turn a finished search into findings.

    Args:
        cut, where, problem, sets, found: What was searched, and the outcome.
        pattern: Share of what a trial leaves that follows one signal.
    """
    end = found.end
    if end.fit.residual.size == 0:
        return Judged(cut, where, problem, sets, found, (), end, False, [], [], [])
    if found.halted:  # what was found so far is what the other cuts go on with; it is judged when everything has been sought
        return Judged(cut, where, problem, sets, found, end.chosen, end, False, [], [], [])
    named = tuple(c for c in end.chosen if not _is_nozzle(c, end))
    nameless = _is_nameless(cut, found.start, end, named, sets, pattern)
    asked = named
    rejected = [
        Rejected(r.effect, r.where, wording.rejected(r, c, worse))
        for c in named
        for r, worse in found.rivals.get(c.key, [])
        if worse > AS_GOOD
    ]
    rejected += [Rejected(c.effect, c.where, wording.no_gain(c, share)) for c, share in found.runners_up]
    trial = end
    if cut == "gas" and not nameless and end.fit.sse > LEFT_OVER * problem.size:  # no two valves are alike
        trial, named = _firm(sets, found, named)
        nameless = named != asked and _is_nameless(cut, found.start, trial, named, sets, pattern)
    if nameless:
        rejected += [
            Rejected(
                c.effect,
                c.where,
                f"explains only {100 * found.weighings[c.key].share:.0f} % and leaves the rest as it was",
            )
            for c in asked
            if c.key in found.weighings
        ]
        apart = [] if _is_hopeless(cut, sets, end) else [c for c in named if _stands_alone(found, c)]
        kept = standing([c for c in apart if c.effect != _HOSE or not _rings(sets, end)])
        if not kept:
            trial = sets.as_believed()
        elif kept != named:
            trial = sets.try_set(kept, end)
        named = kept
    tau = sets.correlation_time(trial.fit.residual)
    spread = spreads(problem, trial.fit, tau)
    findings = [_with_parts(_finding(c, trial, spread, found), found.whole.get(c.key), sets) for c in named]
    findings = _with_twin(findings, cut, _is_offset_bent(trial))
    seen = set()
    standing_beside = {(name, f.where) for f in findings for name in (f.name, *f.ambiguous_with)}
    unique = [r for r in rejected if (r.name, r.where) not in standing_beside]
    unique = [r for r in unique if not ((r.name, r.where) in seen or seen.add((r.name, r.where)))]  # type: ignore[func-returns-value]
    spread = {quantity: error for quantity, error in spread.items() if not unseen(problem, quantity)}
    calibrations = [] if nameless else calibrated(trial, spread)
    refitted = () if nameless else refitted_besides(trial, spread, {quantity for quantity, _, _ in calibrations}, bool(named))
    return Judged(
        cut, where, problem, sets, found, named, trial, nameless, findings, calibrations, unique, refitted=refitted
    )


def _is_offset_bent(trial: Trial) -> bool:
    """Say whether a balance of forces was closed by a constant force that its sensors hardly leave room for."""
    return any(abs(trial.fit.values[q] - q.prior[0]) > SURE * q.prior[1] for q in trial.fit.values if q.effect == "offset" and q.prior)


def _with_twin(findings: list[Finding], cut: str, bent: bool) -> list[Finding]:
    """Name what would look the same: for one supply the other; asymmetric friction for Coulomb friction beside a constant force.

    The constant force is a force sensor's offset that was found, or, where `bent`, what closed the balance.
    """
    if cut == "gas":  # an unmeasured tank behind a feed, and a regulator that lags: the same first order between flow and pressure
        return [_beside(f, *(name for name in _SUPPLIES if name != f.name)) if f.name in _SUPPLIES else f for f in findings]
    if cut == "supply":  # measured as well, where the tank's gas keeps its temperature; only hysteresis is a regulator's own
        return [_beside(f, _TANK) if f.name == _REGULATOR and "hysteresis" not in f.parameters else f for f in findings]
    if cut != "motion" or not any(f.name == "coulomb_friction" for f in findings):
        return findings
    twins = [f for f in findings if f.name == "sensor_bias" and f.where.endswith(".external_force")]
    if bent:
        twins += [f for f in findings if f.name == "coulomb_friction"]
    return [_beside(f, "asymmetric_friction") if f in twins else f for f in findings]


def _beside(finding: Finding, twin: str) -> Finding:
    if twin in finding.ambiguous_with:
        return finding
    equal = dict.fromkeys((finding.name, *finding.ambiguous_with, twin), 1.0 / (2 + len(finding.ambiguous_with)))
    return replace(finding, ambiguous_with=(*finding.ambiguous_with, twin), probabilities=equal)


def _firm(sets: SetFits, found: Found, named: tuple[Candidate, ...]) -> tuple[Trial, tuple[Candidate, ...]]:
    """Return the findings that stand although something is left: the larger part of it is theirs, and surely more than healthy."""
    trial = found.end
    while named:
        spread = spreads(sets.problem, trial.fit, sets.correlation_time(trial.fit.residual))
        firm = standing([c for c in named if _takes_most(found, c) and sizeable(c, trial, None if _is_plain(found, c) else spread)])
        if firm == named:
            break
        trial, named = sets.polished(sets.try_set(firm, trial)), firm
    return trial, named


def _takes_most(found: Found, candidate: Candidate) -> bool:
    weighing = found.weighings.get(candidate.key)
    return weighing is None or weighing.share > LARGER_PART


def _is_plain(found: Found, candidate: Candidate) -> bool:
    """Say whether the odds leave no doubt: what makes its number vague is then only that believed ones could stand in for it."""
    weighing = found.weighings.get(candidate.key)
    return weighing is not None and weighing.log10_odds > PLAIN_ODDS


def _is_nozzle(candidate: Candidate, trial: Trial) -> bool:
    if candidate.effect != "critical_ratio":
        return False
    return _NOZZLE[0] < trial.fit.values[candidate.quantities[0]] < _NOZZLE[1]


def _is_nameless(
    cut: str, begun: Trial, trial: Trial, named: Sequence[Candidate], sets: SetFits, pattern: Callable[[Trial], float]
) -> bool:
    """Say whether too much is left of what there was without names, or believed numbers are bent too far, for the names to be believed."""
    start, end, n = begun.fit, trial.fit, sets.problem.size
    if all(c.effect == _HOSE for c in named) and _rings(sets, trial):
        return True
    left = end.sse / n
    if left < LEFT_OVER or math.sqrt(left) < sets.problem.sick:
        return False
    if not named:
        return left > SICK and (sets.correlation_time(end.residual) > 2.0 or left > 3.0 * SICK)
    if _is_hopeless(cut, sets, trial):
        return True
    explained = (start.sse - end.sse) / max(start.sse - n, 1e-9)
    if explained < EXPLAINED and (explained < HALFWAY or pattern(trial) > PATTERN):
        return True
    believed = [q for q in end.quantities if q.prior is not None and q.effect != "offset"]
    bent = any(abs(end.values[q] - q.prior[0]) > STRAINED * q.prior[1] for q in believed if q.prior)
    return bent and left > SICK


def _is_hopeless(cut: str, sets: SetFits, trial: Trial) -> bool:
    return cut == "gas" and math.sqrt(trial.fit.sse / sets.problem.size) > HOPELESS * sets.problem.sick


def _rings(sets: SetFits, trial: Trial) -> bool:
    return isinstance(sets.problem, GasProblem) and trembles(sets.problem, trial)


def _stands_alone(found: Found, candidate: Candidate) -> bool:
    """Say whether a finding is beyond doubt although something else is left."""
    weighing = found.weighings.get(candidate.key)
    return weighing is not None and _is_plain(found, candidate) and weighing.share > 0.9 and weighing.steady > 3.0


def _finding(candidate: Candidate, trial: Trial, spread: dict[Quantity, float], found: Found) -> Finding:
    parameters = {}
    for quantity in candidate.quantities:
        value = trial.fit.values[quantity]
        low, high = bounds(quantity, value, max(spread.get(quantity, 0.0), MODEL_SHARE * abs(value)))
        if candidate.effect in declared():
            low, high = _opened(candidate, quantity, low, high)
        name = quantity.parameter.rsplit(".", 1)[-1] if quantity.target == "sensor" else quantity.parameter
        name = (
            {"bias": "value", "scale": "factor", "delay": "seconds"}.get(name, name)
            if quantity.target == "sensor"
            else name
        )
        parameters[name] = Estimate(value, quantity.unit, low, high)
    weighing = found.weighings.get(candidate.key)
    rivals = [
        (r, worse)
        for r, worse in found.rivals.get(candidate.key, [])
        if worse <= AS_GOOD and r.effect != candidate.effect
    ]
    weights = {candidate.effect: 1.0, **{r.effect: math.exp(-max(worse, 0.0)) for r, worse in reversed(rivals)}}
    total = sum(weights.values())
    return Finding(
        candidate.effect, candidate.where, candidate.kind, wording.says(candidate.effect), parameters,
        weighing.log10_odds if weighing else 0.0, 0.0, tuple(dict.fromkeys(r.effect for r, _ in rivals)),
        {name: weight / total for name, weight in weights.items()} if rivals else {},
    )  # fmt: skip


def _with_parts(finding: Finding, whole: Trial | None, sets: SetFits) -> Finding:
    """Return a finding whose intervals hold what its numbers are where those that were left out of it take their part."""
    if whole is None:
        return finding
    spread = spreads(sets.problem, whole.fit, sets.correlation_time(whole.fit.residual))
    parameters = dict(finding.parameters)
    for quantity, value in whole.fit.values.items():
        told = parameters.get(quantity.parameter)
        if told is not None and (quantity.effect, quantity.where) == (finding.name, finding.where) and quantity in whole.asked:
            low, high = bounds(quantity, value, spread.get(quantity, 0.0))
            parameters[quantity.parameter] = replace(told, low=min(told.low, low), high=max(told.high, high))
    return replace(finding, parameters=parameters)


def _opened(candidate: Candidate, quantity: Quantity, low: float, high: float) -> tuple[float, float]:
    """Return the ends of an interval with what the law itself leaves open; where a fit holds more of the law, less is open."""
    asked = declared()[candidate.effect].asked
    if asked.closed_by and asked.closed_by in {q.parameter for q in candidate.quantities}:
        return low, high
    down, up = asked.open_by.get(quantity.parameter, (1.0, 1.0))
    return max(low * down, quantity.low), min(high * up, quantity.high)


def finite(value: float) -> float:
    """Return the value, or 0 where it is not a number."""
    return float(value) if np.isfinite(value) else 0.0
