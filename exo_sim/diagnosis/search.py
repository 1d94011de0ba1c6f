"""Which questions the data answer with yes: screened by their signatures, confirmed by full fits, accepted only if material.

Forward with swaps and pruning. A screen projects each candidate's answer clear of the believed numbers; the best few are fitted
whole. One is accepted when its odds bear the correlation of the errors and the size of the library, when most blocks of time gain,
and when its share is larger than what a healthy machine shows.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.fitting import Fit, differences, fit, prior_terms
from exo_sim.diagnosis.quantity import Candidate, Quantity

Array = NDArray[np.float64]

#: log10 of the odds that a finding must have against leaving it out.
LEAST_ODDS = 2.0
#: Share of the explainable error that a finding must explain.
LEAST_SHARE = 0.10
#: Gain in log-likelihood a healthy machine's imperfect model shows, as a share of the rows: the material floor.
HEALTHY_GAIN = 0.004
#: Residual variance in units of the noise that counts as nothing left.
CLEAN = 1.8
#: A simpler question that explains this share of what the best one does is taken in its place.
NEARLY = 0.93
#: ... unless its log-likelihood is lower by more than this.
NO_WORSE = 12.0
#: Fewer rows than this cannot be asked anything.
FEWEST_ROWS = 30
#: How many of the screened candidates are fitted whole.
FINALISTS = 4


class Problem(Protocol):
    """What the search needs of a cut."""

    blocks: NDArray[np.int64]

    @property
    def size(self) -> int: ...

    @property
    def sick(self) -> float: ...

    def residual(self, values: dict[Quantity, float], fixed: Sequence[tuple[Quantity, float]] = ()) -> Array: ...


@dataclass
class Trial:
    """One set of candidates, fitted."""

    chosen: tuple[Candidate, ...]
    fit: Fit

    @property
    def keys(self) -> set[tuple[str, str]]:
        """Effects and places that are in it."""
        return {(candidate.effect, candidate.where) for candidate in self.chosen}


@dataclass
class Weighing:
    """How much better one trial is than another.

    Attributes:
        log10_odds: Corrected for correlation, parameters and the size of the library.
        gain: Difference in log-likelihood, corrected for correlation.
        share: Part of the explainable error that it explains.
        steady: Mean gain over blocks in units of its standard error.
        material: Gain in log-likelihood a row, before the correction.
    """

    log10_odds: float
    gain: float
    share: float
    steady: float
    material: float


@dataclass
class Found:
    """What a search ended with.

    Attributes:
        start: Believed numbers refitted, nothing added.
        end: With everything that was accepted.
        weighings: By candidate key: what dropping it would cost.
        rivals: By candidate key: what would take its place and how much worse that fits (log-likelihood).
        runners_up: Candidates that were considered at the end and not accepted, with what they would gain.
    """

    start: Trial
    end: Trial
    weighings: dict[tuple[str, str, str], Weighing] = field(default_factory=dict)
    rivals: dict[tuple[str, str, str], list[tuple[Candidate, float]]] = field(default_factory=dict)
    runners_up: list[tuple[Candidate, Weighing]] = field(default_factory=list)


def sizeable(candidate: Candidate, trial: Trial) -> bool:
    """Say whether any of a candidate's numbers is further from neutral than a healthy machine's would be."""
    values = trial.fit.values
    if not any(q.least > 0.0 for q in candidate.quantities):
        return True
    return any(abs(values[q] - q.neutral) > q.least for q in candidate.quantities)


class Search:
    """A search over one problem.

    Args:
        problem: The cut.
        nuisances: Believed numbers, refitted in every comparison.
        library: The questions.
        pool: Threads.
        progress: Told in a few words what is going on.
        most: The most findings.
        finalists: How many of the screened candidates are fitted whole.
        material: Drop of the root-mean-square error, in units of the noise, below which nothing is a finding.
    """

    def __init__(
        self,
        problem: Problem,
        nuisances: Sequence[Quantity],
        library: Sequence[Candidate],
        pool: ThreadPoolExecutor | None = None,
        progress: Callable[[str], None] | None = None,
        most: int = 5,
        finalists: int = FINALISTS,
        material: float = 0.0,
    ):
        self.problem, self.nuisances, self.library = problem, tuple(nuisances), tuple(library)
        self.pool, self.most, self.finalists, self.material = pool, most, finalists, material
        self._say = progress or (lambda words: None)
        self._whole: Trial | None = None
        self._fitted: dict[frozenset[tuple[str, str, str]], Trial] = {}

    # -- fitting -----------------------------------------------------------------------------------------------------

    def try_set(self, chosen: Sequence[Candidate], start: dict[Quantity, float], tolerance: float = 2e-3) -> Trial:
        """Fit the believed numbers and these candidates together, from `start` where it says and typical values else."""
        key = frozenset(candidate.key for candidate in chosen)
        if key in self._fitted:
            return self._fitted[key]
        fixed = [pair for candidate in chosen for pair in candidate.fixed]
        quantities = (*self.nuisances, *(q for candidate in chosen for q in candidate.quantities))
        fresh = [candidate for candidate in chosen if any(q not in start for q in candidate.quantities)]
        begun = {q: start.get(q, q.prior[0] if q.prior else q.neutral) for q in quantities}
        options = [begun]
        for candidate in fresh:
            options = [
                {**o, **dict(zip(candidate.quantities, values, strict=True))}
                for o in options
                for values in candidate.starts
            ]

        def residual(values: dict[Quantity, float]) -> Array:
            return self.problem.residual(values, fixed)

        if len(options) > 1:
            costs = [float(np.sum(residual(option) ** 2)) for option in options]
            options = [options[int(np.argmin(costs))]]
        trial = Trial(tuple(chosen), fit(residual, quantities, options[0], self.pool, most=6, tolerance=tolerance))
        self._fitted[key] = trial
        return trial

    def as_believed(self) -> Trial:
        """Return the machine as its owner believes it, nothing refitted: what is left to look at when no name will do."""
        values = {q: q.prior[0] if q.prior else q.neutral for q in self.nuisances}
        return Trial((), Fit((), values, self.problem.residual(values), np.zeros((self.problem.size, 0)), 0.0))

    # -- weighing ----------------------------------------------------------------------------------------------------

    def correlation_time(self, residual: Array) -> float:
        """Return how many neighbouring rows say the same, at least 1: the integrated autocorrelation inside blocks."""
        blocks = self.problem.blocks
        centred = residual
        variance = float(centred @ centred) / max(centred.size, 1)
        if variance <= 0.0:
            return 1.0
        total = 1.0
        for lag in range(1, 200):
            same = blocks[lag:] == blocks[:-lag]
            if same.sum() < 20:
                break
            rho = float(np.mean(centred[lag:][same] * centred[:-lag][same])) / variance
            if rho < 0.05:
                break
            total += 2.0 * rho
        return total

    def weigh(self, without: Trial, with_it: Trial, added: int) -> Weighing:
        """Say how much better `with_it` explains the training time than `without`, which has `added` fewer numbers."""
        n = self.problem.size
        a, b = without.fit.sse, with_it.fit.sse
        tau = max(self.correlation_time(with_it.fit.residual), 1.0)
        material = 0.5 * math.log(max(without.fit.cost, 1e-12) / max(with_it.fit.cost, 1e-12))
        gain = material * n / tau
        odds = (gain - 0.5 * added * math.log(max(n / tau, 2.0))) / math.log(10.0) - math.log10(
            max(len(self.library), 1)
        )
        explainable = max(a - min(n, b), 1e-12)
        per_block = np.bincount(self.problem.blocks, weights=without.fit.residual**2 - with_it.fit.residual**2)
        present = np.bincount(self.problem.blocks) > 0
        gains = per_block[present]
        error = float(gains.std(ddof=1)) / math.sqrt(gains.size) if gains.size > 1 else math.inf
        steady = float(gains.mean()) / error if error > 0.0 else math.inf
        return Weighing(odds, gain, max(a - b, 0.0) / explainable, steady, material)

    def accepts(self, weighing: Weighing, without: Trial, with_it: Trial) -> bool:
        """Say whether a finding passes every gate.

        Once nine tenths are explained, a further effect must leave the noise, or take half of what is left: the last tenth of a real
        machine is shaped like nothing in particular, and everything fits a little of it.
        """
        steady = weighing.steady > 2.0 or weighing.share > 0.2
        n = self.problem.size
        whole = self._whole if self._whole is not None else without
        explained = 1.0 - max(without.fit.sse - n, 0.0) / max(whole.fit.sse - n, 1e-9)
        wanted = LEAST_SHARE if explained < 0.9 or with_it.fit.sse < CLEAN * n else 0.5
        if math.sqrt(without.fit.sse / n) - math.sqrt(with_it.fit.sse / n) < self.material:
            return False
        return (
            weighing.log10_odds > LEAST_ODDS and weighing.share > wanted and steady and weighing.material > HEALTHY_GAIN
        )

    # -- screening ---------------------------------------------------------------------------------------------------

    def screen(self, now: Trial, skip: set[tuple[str, str]]) -> list[tuple[float, Candidate]]:
        """Return candidates by how much of the present error their signatures could explain, best first."""
        base = now.fit.residual
        fixed_now = [pair for candidate in now.chosen for pair in candidate.fixed]
        jacobian = now.fit.jacobian
        _, prior_jac = prior_terms(now.fit.quantities, now.fit.values)
        basis = np.linalg.qr(np.vstack([jacobian, prior_jac]))[0] if jacobian.shape[1] else np.zeros((base.size, 0))
        prior_rows, _ = prior_terms(now.fit.quantities, now.fit.values)
        target = np.concatenate([base, prior_rows])
        target = target - basis @ (basis.T @ target)
        level = math.sqrt(float(base @ base) / max(base.size, 1))

        def score(candidate: Candidate) -> tuple[float, Candidate]:
            best = 0.0
            for start in candidate.starts:
                change, _ = self._answer(candidate, start, now, fixed_now, base, level)
                if change is None:
                    continue
                clear = np.concatenate([change, np.zeros(len(prior_rows))])
                clear -= basis @ (basis.T @ clear)
                strength = float(clear @ clear)
                pull = -float(clear @ target)
                if strength <= 1e-12 * float(change @ change) or strength == 0.0:
                    continue
                one_sided = all(q.low >= q.neutral for q in candidate.quantities)
                if pull <= 0.0 and one_sided:
                    continue
                best = max(best, pull * pull / strength)
            return best, candidate

        open_questions = [c for c in self.library if (c.effect, c.where) not in skip]
        scored = list(self.pool.map(score, open_questions)) if self.pool else [score(c) for c in open_questions]
        return sorted(scored, key=lambda pair: -pair[0])

    def _answer(
        self,
        candidate: Candidate,
        start: tuple[float, ...],
        now: Trial,
        fixed_now: list[tuple[Quantity, float]],
        base: Array,
        level: float,
    ) -> tuple[Array | None, dict[Quantity, float]]:
        """Return how the residual changes when the candidate is put in at a size that shows but does not swamp."""
        size = 1.0
        for _ in range(4 if candidate.proportional else 1):
            values = {
                q: float(np.clip(q.neutral + size * (v - q.neutral), q.low, q.high))
                for q, v in zip(candidate.quantities, start, strict=True)
            }
            change = self.problem.residual({**now.fit.values, **values}, [*fixed_now, *candidate.fixed]) - base
            if not np.isfinite(change).all():
                return None, values
            strength = math.sqrt(float(change @ change) / change.size)
            if strength > 10.0 * level and size > 1e-3:
                size *= 0.2
            elif strength < 0.02 * level and size < 50.0:
                size *= 10.0
            else:
                break
        return change, values

    # -- the search --------------------------------------------------------------------------------------------------

    def run(self) -> Found:
        """Search forward, swap and prune, then weigh every finding and its rivals."""
        self._say("refitting believed numbers")
        if self.problem.size < FEWEST_ROWS:
            start = Trial((), Fit((), {}, np.zeros(0), np.zeros((0, 0)), 0.0))
            return Found(start, start)
        start = now = self._whole = self.try_set((), {})
        ranked: list[tuple[float, Candidate]] = []
        for _ in range(self.most):
            self._say(f"screening {len(self.library)} questions")
            ranked = self.screen(now, now.keys)
            best = self._best_addition(now, ranked)
            if best is None:
                break
            self._say(f"{best.chosen[-1].effect.replace('_', ' ')} joins")
            now = self._swapped(best, ranked)
            now = self._simplest(self._pruned(now))
        now = self._pruned(now, keep_newest=False)
        found = Found(start, now)
        self._judge(found, ranked)
        return found

    def _finalists(self, ranked: list[tuple[float, Candidate]], count: int | None = None) -> list[Candidate]:
        count = self.finalists if count is None else max(count, self.finalists if self.finalists > FINALISTS else 0)
        picked: list[Candidate] = []
        for score, candidate in ranked:
            if len(picked) >= count or score <= 0.0:
                break
            if sum(1 for other in picked if (other.effect, other.where) == (candidate.effect, candidate.where)) < 2:
                picked.append(candidate)
        return picked

    def _best_addition(self, now: Trial, ranked: list[tuple[float, Candidate]]) -> Trial | None:
        """Return the best of the accepted additions; of two that explain nearly the same, the one with fewer numbers."""
        accepted = []
        for candidate in self._finalists(ranked):
            trial = self.try_set((*now.chosen, candidate), now.fit.values)
            weighing = self.weigh(now, trial, len(candidate.quantities))
            if self.accepts(weighing, now, trial) and sizeable(candidate, trial):
                accepted.append((weighing.log10_odds, len(candidate.quantities), trial))
        if not accepted:
            return None
        best = max(accepted, key=lambda one: one[0])
        gain = now.fit.cost - best[2].fit.cost
        rows = self.problem.size / self.correlation_time(best[2].fit.residual)
        simpler = [
            one
            for one in accepted
            if one[1] < best[1]
            and now.fit.cost - one[2].fit.cost > NEARLY * gain
            and 0.5 * rows * math.log(one[2].fit.cost / best[2].fit.cost) < NO_WORSE
        ]
        return max(simpler, key=lambda one: one[0])[2] if simpler else best[2]

    def _swapped(self, now: Trial, ranked: list[tuple[float, Candidate]]) -> Trial:
        """Try, for every finding, whether another question in its place explains more."""
        for index in range(len(now.chosen) if self.finalists > FINALISTS else len(now.chosen) - 1):
            kept = (*now.chosen[:index], *now.chosen[index + 1 :])
            base = self.try_set(kept, now.fit.values)
            for candidate in self._finalists(self.screen(base, base.keys), 4):
                if (candidate.effect, candidate.where) in now.keys:
                    continue
                trial = self.try_set((*kept, candidate), base.fit.values)
                if trial.fit.cost + 2.0 * len(candidate.quantities) < now.fit.cost - 0.001 * self.problem.size:
                    now = trial
                    break
        return now

    def _pruned(self, now: Trial, keep_newest: bool = True) -> Trial:
        while len(now.chosen) > (1 if keep_newest else 0):
            for index, candidate in enumerate(now.chosen[:-1] if keep_newest else now.chosen):
                kept = (*now.chosen[:index], *now.chosen[index + 1 :])
                without = self.try_set(kept, now.fit.values)
                if not self.accepts(self.weigh(without, now, len(candidate.quantities)), without, now):
                    now = without
                    break
            else:
                break
        return now

    def _simplest(self, now: Trial) -> Trial:
        """Put each finding in the form that needs fewest numbers for what it explains; where fits are cheap, in a plainer one's place."""
        for candidate in now.chosen:
            best = now
            for form in self.library:
                same = (form.effect, form.where) == (candidate.effect, candidate.where)
                plainer = self.finalists > FINALISTS and len(form.quantities) < len(candidate.quantities)
                if form.key == candidate.key or not (same or (plainer and (form.effect, form.where) not in now.keys)):
                    continue
                if same and len(form.quantities) > len(candidate.quantities) + 2:
                    continue
                others = tuple(form if c.key == candidate.key else c for c in now.chosen)
                trial = self.try_set(others, now.fit.values)
                fewer = same and len(form.quantities) < sum(
                    len(c.quantities) for c in best.chosen if c.effect == form.effect
                )
                if self._is_better(trial, best) or (fewer and self._hardly_loses(trial, best)):
                    best = trial
            now = best
        return now

    def _hardly_loses(self, one: Trial, other: Trial) -> bool:
        """Say whether the plainer form of an effect explains all but a thousandth of what the fuller one does."""
        whole = self._whole.fit.cost if self._whole else one.fit.cost
        return whole - one.fit.cost > 0.999 * (whole - other.fit.cost) or self._loss(one, other) < NO_WORSE

    def _loss(self, one: Trial, other: Trial) -> float:
        """Return by how much one trial's log-likelihood is lower than another's."""
        rows = self.problem.size / self.correlation_time(other.fit.residual)
        return 0.5 * rows * math.log(max(one.fit.cost, 1e-12) / max(other.fit.cost, 1e-12))

    def _is_better(self, one: Trial, other: Trial) -> bool:
        """Say whether one trial explains more than another for what its numbers cost, both by the better one's correlation."""
        cleaner = one if one.fit.sse < other.fit.sse else other
        rows = self.problem.size / self.correlation_time(cleaner.fit.residual)
        gain = rows * math.log(max(other.fit.cost, 1e-12) / max(one.fit.cost, 1e-12))
        more = sum(len(c.quantities) for c in one.chosen) - sum(len(c.quantities) for c in other.chosen)
        return gain > more * math.log(max(rows, 2.0))

    def _judge(self, found: Found, ranked: list[tuple[float, Candidate]]) -> None:
        """Weigh each finding against leaving it out and against what could take its place."""
        end = found.end
        for index, candidate in enumerate(end.chosen):
            kept = (*end.chosen[:index], *end.chosen[index + 1 :])
            without = self.try_set(kept, end.fit.values)
            found.weighings[candidate.key] = self.weigh(without, end, len(candidate.quantities))
            rivals = []
            tau = self.correlation_time(end.fit.residual)
            for rival in self._finalists(self.screen(without, without.keys), 4):
                if (rival.effect, rival.where) == (candidate.effect, candidate.where):
                    continue
                trial = self.try_set((*kept, rival), without.fit.values)
                worse = 0.5 * math.log(max(trial.fit.cost, 1e-12) / max(end.fit.cost, 1e-12)) * self.problem.size / tau
                rivals.append((rival, worse))
            found.rivals[candidate.key] = sorted(rivals, key=lambda pair: pair[1])
        for candidate in self._finalists(ranked, 3):
            if (candidate.effect, candidate.where) not in end.keys:
                trial = self.try_set((*end.chosen, candidate), end.fit.values)
                found.runners_up.append((candidate, self.weigh(end, trial, len(candidate.quantities))))


def column_jacobian(problem: Problem, trial: Trial) -> Array:
    """Return the Jacobian of a fitted trial anew, shape (size, p)."""
    fixed = [pair for candidate in trial.chosen for pair in candidate.fixed]
    return differences(
        lambda v: problem.residual(v, fixed), trial.fit.quantities, trial.fit.values, trial.fit.residual, None
    )
