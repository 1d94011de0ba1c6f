"""Fits of sets of candidates together with the nuisance parameters, each started from a similar one and kept."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.correlation import correlation_time
from exo_sim.diagnosis.estimation.least_squares import Fit, fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.estimation.uncertainty import standard_errors
from exo_sim.diagnosis.policy import gates
from exo_sim.diagnosis.policy.budgets import CHEAP_STARTS
from exo_sim.diagnosis.selection.evidence import negative_log_likelihood
from exo_sim.diagnosis.selection.fitted_model import FittedModel, LeastSquaresModel, SetKey, key_of

Array = NDArray[np.float64]


class ModelFits:
    """Fits of sets of candidates to one subsystem.

    Args:
        model: The subsystem.
        nuisances: Nuisance parameters, refitted with every set.
        threads: Threads; the results do not depend on how many.
        cheap: Whether predictions cost little: then every fit begins from several starts, and from scratch.
    """

    def __init__(
        self, model: LeastSquaresModel, nuisances: Sequence[FreeParameter], threads: Threads = SERIAL, cheap: bool = False
    ):
        self.model, self.nuisances, self.threads, self.cheap = model, tuple(nuisances), threads, cheap
        self._fitted: dict[SetKey, FittedModel] = {}

    def fit(self, candidates: Sequence[Candidate], near: FittedModel | None = None, again: bool = False) -> FittedModel:
        """Fit these candidates, started from a similar model and, for parameters that it does not have, from typical values.

        With `again` a set that was fitted before is fitted from here as well, and the better fit kept.
        """
        key = key_of(candidates)
        before = self._fitted.get(key)
        if before is not None and not again:
            return before
        start = near.fit.values if near else {}
        parameters = (*self.nuisances, *(q for candidate in candidates for q in candidate.parameters))
        begun = {q: start.get(q, q.start) for q in parameters}
        options = [begun]
        new = [q for q in parameters if q not in start]
        if near and new and (self.cheap or any(q.nonsmooth for q in new)):  # what is missing may have bent the nuisance parameters
            options.append({**begun, **{q: q.prior[0] for q in self.nuisances if q.prior}})
        for candidate in candidates:
            if any(q not in start for q in candidate.parameters):
                options = [{**o, **dict(zip(candidate.parameters, values, strict=True))} for o in options for values in candidate.starts]
        residual = self._residual_of(candidates)
        errors = [residual(option) for option in options]
        order = np.argsort([float(e @ e) if np.isfinite(e).all() else np.inf for e in errors])
        length = min(self.correlation_time(errors[order[0]]), gates.LONGEST_CORRELATION)
        if self.cheap:
            done = self._fit_cheaply(residual, parameters, [options[i] for i in order], length)
        else:
            columns = near.fit.columns if near else None
            done = fit(
                residual, parameters, options[order[0]], self.threads, max_iterations=12, correlation_length=length, known_columns=columns
            )
        fitted = FittedModel(tuple(candidates), done)
        if before is not None and self.deficit(before, fitted) <= 0.0:
            return before
        self._fitted[key] = fitted
        return fitted

    def _fit_cheaply(
        self,
        residual: Callable[[dict[FreeParameter, float]], Array],
        parameters: Sequence[FreeParameter],
        options: Sequence[dict[FreeParameter, float]],
        length: float,
    ) -> Fit:
        """Return the best of several fits, from scratch; `options` are the starts, best first."""
        tried = [
            fit(residual, parameters, start, self.threads, max_iterations=24, tolerance=1e-5, correlation_length=length)
            for start in options[:CHEAP_STARTS]
        ]
        done = min(tried, key=lambda one: one.sse + one.prior_weight * one.penalty)
        missing = done.sse - self.model.size
        if length > gates.HELD_BACK and missing > self.model.size:
            free = fit(residual, parameters, options[0], self.threads, max_iterations=24, tolerance=1e-5)
            done = free if free.sse - self.model.size < gates.LEFT_WHEN_FREE * missing else done
        return done

    def fit_all(self, asked: Sequence[tuple[Sequence[Candidate], FittedModel]], again: bool = False) -> list[FittedModel]:
        """Fit several sets in parallel, each from a similar model; a set that is asked for twice is started from the first one's."""
        first = {key_of(candidates): (candidates, near) for candidates, near in reversed(asked)}
        fitted = dict(zip(first, self.threads.fits(lambda one: self.fit(one[0], one[1], again), list(first.values())), strict=True))
        return [fitted[key_of(candidates)] for candidates, _ in asked]

    def refined(self, model: FittedModel) -> FittedModel:
        """Return a model fitted to convergence, with an exact Jacobian: its values are going to be reported."""
        if not model.fit.residual.size:
            return model
        parameters = (*self.nuisances, *(q for candidate in model.candidates for q in candidate.parameters))
        length = min(self.correlation_time(model.fit.residual), gates.LONGEST_CORRELATION)
        done = fit(
            self._residual_of(model.candidates), parameters, model.fit.values, self.threads, max_iterations=12, tolerance=1e-6,
            correlation_length=length, known_columns=model.fit.columns, exact_jacobian=True,
        )  # fmt: skip
        better = FittedModel(model.candidates, done)
        self._fitted[key_of(model.candidates)] = better
        return better

    def _residual_of(self, candidates: Sequence[Candidate]) -> Callable[[dict[FreeParameter, float]], Array]:
        fixed = [pair for candidate in candidates for pair in candidate.fixed]
        return lambda values: self.model.residual(values, fixed)

    def nominal(self) -> FittedModel:
        """Return the machine as its owner believes it, nothing fitted."""
        values = {q: q.start for q in self.nuisances}
        return FittedModel((), Fit((), values, self.model.residual(values), np.zeros((self.model.size, 0))))

    def correlation_time(self, residual: Array) -> float:
        """Return the integrated autocorrelation time of a residual, in rows."""
        return correlation_time(residual, self.model.blocks)

    def standard_errors(self, fitted: FittedModel) -> dict[FreeParameter, float]:
        """Return the standard error of every parameter of a fitted model, in its unit."""
        return standard_errors(self.model, fitted.fit, self.correlation_time(fitted.fit.residual))

    def effective_sample_size(self, models: Sequence[FittedModel]) -> float:
        """Return the number of independent rows in the residual of the best of these models."""
        best = min(models, key=lambda model: model.fit.sse)
        return self.model.size / self.correlation_time(best.fit.residual)

    def deficit(self, one: FittedModel, other: FittedModel) -> float:
        """Return by how much one model's log-likelihood is lower than another's, on the independent rows of the better one."""
        rows = self.effective_sample_size((one, other))
        return negative_log_likelihood(one.fit, rows) - negative_log_likelihood(other.fit, rows)
