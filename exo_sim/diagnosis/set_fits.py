"""Fits of sets of candidates with the believed numbers, each from one near by; what was fitted once is kept."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.fitted_set import Problem, SetKey, Trial, key_of
from exo_sim.diagnosis.fitting import Fit, fit
from exo_sim.diagnosis.quantity import Candidate, Quantity
from exo_sim.diagnosis.threads import ALONE, Threads
from exo_sim.diagnosis.weighing import correlation_time, loss

Array = NDArray[np.float64]

#: From how many of its starts a candidate is fitted where that costs little.
CHEAP_STARTS = 3
#: Errors that come in spells longer than this, in rows, hold the believed numbers back; where these, set free, leave no more than this
#: share of what was missing, it was they that were off, and not something else in spells.
HELD_BACK, LEFT_OF_SPELL = 3.0, 0.01
#: The longest spell of equal errors that a fit is told of, in rows.
LONGEST_SPELL = 60.0


class SetFits:
    """Fits to one problem.

    Args:
        problem: The cut.
        nuisances: Believed numbers, refitted with every set.
        threads: Threads; what comes out does not depend on how many.
        cheap: Whether predictions cost little: then every fit begins from several starts and is done from scratch.
    """

    def __init__(self, problem: Problem, nuisances: Sequence[Quantity], threads: Threads = ALONE, cheap: bool = False):
        self.problem, self.nuisances, self.threads, self.cheap = problem, tuple(nuisances), threads, cheap
        self._fitted: dict[SetKey, Trial] = {}

    def try_set(self, chosen: Sequence[Candidate], near: Trial | None = None, again: bool = False) -> Trial:
        """Fit the believed numbers and these candidates together, from a trial near by and typical values where it has none.

        With `again` a set that was fitted before is fitted from here as well, and the better one kept.
        """
        key = key_of(chosen)
        before = self._fitted.get(key)
        if before is not None and not again:
            return before
        start = near.fit.values if near else {}
        quantities = (*self.nuisances, *(q for candidate in chosen for q in candidate.quantities))
        begun = {q: start.get(q, q.prior[0] if q.prior else q.neutral) for q in quantities}
        options = [begun]
        new = [q for q in quantities if q not in start]
        if near and new and (self.cheap or any(q.rough for q in new)):  # what is missing may have bent the believed numbers
            options.append({**begun, **{q: q.prior[0] for q in self.nuisances if q.prior}})
        for candidate in chosen:
            if any(q not in start for q in candidate.quantities):
                options = [{**o, **dict(zip(candidate.quantities, values, strict=True))} for o in options for values in candidate.starts]
        residual = self._residual_of(chosen)
        errors = [residual(option) for option in options]
        order = np.argsort([float(e @ e) if np.isfinite(e).all() else np.inf for e in errors])
        spell = min(self.correlation_time(errors[order[0]]), LONGEST_SPELL)
        if self.cheap:
            begins = [options[i] for i in order[:CHEAP_STARTS]]
            tried = [fit(residual, quantities, begin, self.threads, most=24, tolerance=1e-5, spell=spell) for begin in begins]
            done = min(tried, key=lambda one: one.sse + one.weight * one.penalty)
            missing = done.sse - self.problem.size
            if spell > HELD_BACK and missing > self.problem.size:
                free = fit(residual, quantities, options[order[0]], self.threads, most=24, tolerance=1e-5)
                done = free if free.sse - self.problem.size < LEFT_OF_SPELL * missing else done
        else:
            known = dict(zip(near.fit.quantities, near.fit.jacobian.T, strict=True)) if near else None
            done = fit(residual, quantities, options[order[0]], self.threads, most=12, spell=spell, known=known)
        trial = Trial(tuple(chosen), done)
        if before is not None and self.loses(before, trial) <= 0.0:
            return before
        self._fitted[key] = trial
        return trial

    def try_sets(self, asked: Sequence[tuple[Sequence[Candidate], Trial]], again: bool = False) -> list[Trial]:
        """Fit several sets side by side, each from the trial near by; a set that is asked for twice is fitted for the first who asks."""
        first = {key_of(chosen): (chosen, near) for chosen, near in reversed(asked)}
        fitted = dict(zip(first, self.threads.fits(lambda one: self.try_set(one[0], one[1], again), list(first.values())), strict=True))
        return [fitted[key_of(chosen)] for chosen, _ in asked]

    def polished(self, trial: Trial) -> Trial:
        """Return a trial fitted to the end: its numbers are going to be told."""
        if not trial.fit.residual.size:
            return trial
        quantities = (*self.nuisances, *(q for candidate in trial.chosen for q in candidate.quantities))
        spell = min(self.correlation_time(trial.fit.residual), LONGEST_SPELL)
        residual = self._residual_of(trial.chosen)
        known = dict(zip(trial.fit.quantities, trial.fit.jacobian.T, strict=True))
        done = fit(residual, quantities, trial.fit.values, self.threads, most=12, tolerance=1e-6, spell=spell, known=known, exact=True)
        better = Trial(trial.chosen, done)
        self._fitted[key_of(trial.chosen)] = better
        return better

    def _residual_of(self, chosen: Sequence[Candidate]) -> Callable[[dict[Quantity, float]], Array]:
        fixed = [pair for candidate in chosen for pair in candidate.fixed]
        return lambda values: self.problem.residual(values, fixed)

    def as_believed(self) -> Trial:
        """Return the machine as its owner believes it, nothing refitted: what is left to look at when no name will do."""
        values = {q: q.prior[0] if q.prior else q.neutral for q in self.nuisances}
        return Trial((), Fit((), values, self.problem.residual(values), np.zeros((self.problem.size, 0))))

    def correlation_time(self, residual: Array) -> float:
        """Return how many neighbouring rows of a residual say the same."""
        return correlation_time(residual, self.problem.blocks)

    def rows(self, trials: Sequence[Trial]) -> float:
        """Return how many different things the rows say, as the errors of the cleanest of these trials count."""
        cleanest = min(trials, key=lambda trial: trial.fit.sse)
        return self.problem.size / self.correlation_time(cleanest.fit.residual)

    def loses(self, one: Trial, other: Trial) -> float:
        """Return by how much one trial's log-likelihood is lower than another's, as the cleaner one's errors count."""
        rows = self.rows((one, other))
        return loss(one.fit, rows) - loss(other.fit, rows)
