"""Fits of sets of candidates together with the nuisance parameters, each started from a similar one and kept."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.common_part import with_common_parts_split
from exo_sim.diagnosis.estimation.correlation import correlation_time
from exo_sim.diagnosis.estimation.least_squares import TOLERANCE, Derivatives, Fit, Residual, fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Values
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.estimation.uncertainty import error_of_sum, standard_errors
from exo_sim.diagnosis.nominal_numbers import CARD_OF_PRESSURES, POSITION_DELAY
from exo_sim.diagnosis.policy import acceptance
from exo_sim.diagnosis.policy.budgets import CHEAP_STARTS, FIRST_LOOK, LAW_STARTS, MOST_REDUCED, MOST_STEPS, REDUCED, STRAY, WORTH_A_LOOK
from exo_sim.diagnosis.selection.evidence import negative_log_likelihood
from exo_sim.diagnosis.selection.fitted_model import FittedModel, LeastSquaresModel, SetKey, key_of
from exo_sim.diagnosis.selection.score_test import Promised, Sizes, in_proportion

Array = NDArray[np.float64]

#: A fit whose values are reported goes on until a step lowers its cost by less than this share.
CONVERGED = 1e-6


def _cost(one: Fit) -> float:
    """Return what a fit minimises."""
    return one.sse + one.prior_weight * one.penalty


def _as_ended(candidate: Candidate, ended: Mapping[tuple[str, str], float]) -> tuple[float, ...]:
    """Return where a candidate begins whose numbers a similar model had among those that are refitted in every model: where they ended.

    Args:
        candidate: Of which the other numbers begin at its first start.
        ended: By slot.
    """
    usual = zip(candidate.parameters, candidate.starts[0], strict=True)
    return tuple(min(max(ended.get(q.slot, value), q.low), q.high) for q, value in usual)


class ModelFits:
    """Fits of sets of candidates to one subsystem.

    Args:
        model: The subsystem.
        nuisances: Nuisance parameters, refitted with every set.
        threads: Threads; the results do not depend on how many.
        cheap: Whether predictions cost little: then every fit begins from several starts, and from scratch.
        is_spent: Whether the time is up: then every fit ends where it is.

    Attributes:
        signature_sizes: Of the candidates, as they were asked last.
        promised: Where candidates left least along their signatures, as they were asked last: a fit may begin there, too. What a usual
            size does to a small and quiet machine may be hundreds of times the noise, and from there no fit comes back.
    """

    def __init__(
        self, model: LeastSquaresModel, nuisances: Sequence[FreeParameter], threads: Threads = SERIAL, cheap: bool = False,
        is_spent: IsSpent = never,
    ):  # fmt: skip
        self.is_spent = is_spent
        self.model, self.nuisances, self.threads, self.cheap = model, tuple(nuisances), threads, cheap
        self.signature_sizes: Sizes = {}
        self.promised: Promised = {}
        self._fitted: dict[SetKey, FittedModel] = {}

    def fit(self, candidates: Sequence[Candidate], near: FittedModel | None = None, again: bool = False) -> FittedModel:
        """Fit these candidates, started from a similar model and, for parameters that it does not have, from typical values.

        With `again` a set that was fitted before is fitted from here as well, and the better fit kept.
        """
        key = key_of(candidates)
        before = self._fitted.get(key)
        if before is not None and not again:
            return before
        fitted = self._fitted_from(candidates, near)
        if before is not None and self.deficit(before, fitted) <= 0.0:
            return before
        self._fitted[key] = fitted
        return fitted

    def _fitted_from(self, candidates: Sequence[Candidate], near: FittedModel | None) -> FittedModel:
        """Return the fit of a set, whatever is known of it."""
        parameters, options = self._starts(candidates, near)
        residual = self._residual_of(candidates)
        begin, length, order = self._best_start(residual, options)
        if self.cheap:
            done = self._fit_cheaply(residual, parameters, [options[i] for i in order], length)
        else:
            columns = near.fit.columns if near else None
            if any(candidate.is_law for candidate in candidates):
                begin = self._furthest_led(residual, parameters, [options[i] for i in order], length, columns)
            begin = self._not_astray(residual, begin, candidates, near)
            done = fit(
                residual, parameters, begin, self.threads, max_iterations=MOST_STEPS, correlation_length=length,
                derivatives=Derivatives(columns), is_spent=self.is_spent,
            )  # fmt: skip
        return FittedModel(tuple(candidates), with_common_parts_split(done))

    def look(self, candidates: Sequence[Candidate], near: FittedModel, again: bool = False) -> FittedModel:
        """Return a model after its first steps from a similar one, with the derivatives of that: where a fit would about lead.

        Each of these steps must be worth it. A set that was fitted before is returned as it is, unless it is asked for `again` and the
        look leaves less.
        """
        before = self._fitted.get(key_of(candidates))
        if self.cheap or (before is not None and not again):
            return before or self.fit(candidates, near)
        looked = self._looked_from(candidates, near)
        return before if before is not None and self.deficit(before, looked) <= 0.0 else looked

    def _looked_from(self, candidates: Sequence[Candidate], near: FittedModel) -> FittedModel:
        """Return a set after its first steps, whatever is known of it."""
        parameters, options = self._starts(candidates, near)
        residual = self._residual_of(candidates)
        begin, length, _ = self._best_start(residual, options)
        begin = self._not_astray(residual, begin, candidates, near)
        return FittedModel(tuple(candidates), self._first_steps(residual, parameters, begin, length, near.fit.columns))

    def fit_rivals(
        self, asked: Sequence[tuple[Sequence[Candidate], FittedModel]], aim: FittedModel | None = None, again: bool = False
    ) -> list[FittedModel]:
        """Fit sets that may explain as much as a model does: to the end only those that a first look leaves near it.

        Args:
            asked: Sets of candidates, each with a similar model.
            aim: What they are held against; the one of them that leaves least where absent.
            again: Whether a set that was fitted before is looked at from here as well.
        """
        if self.cheap:
            return self.fit_all(asked, again)
        looks = self.threads.fits(lambda one: self.look(one[0], one[1], again), list(asked))
        aimed = aim or min(looks, key=lambda one: one.fit.sse, default=None)
        close = [one for one in looks if aimed and not self._is_known(one) and not self._is_far(one, aimed)]
        whole = dict(zip([id(one) for one in close], self.fit_all([(one.candidates, one) for one in close], again), strict=True))
        return [whole.get(id(one), one) for one in looks]

    def fit_from_each(self, asked: Sequence[Sequence[Candidate]], now: FittedModel) -> FittedModel | None:
        """Return the best fit of sets that differ in their starts alone; None where first looks lead none of them near a model.

        To all else they are one set, so each is begun whatever is known of it, and what is known is compared one after the other.

        Args:
            asked: The sets.
            now: The model that they begin at, and are held against.
        """
        begin = self._fitted_from if self.cheap else self._looked_from
        near = [one for one in self.threads.fits(lambda one: begin(one, now), list(asked)) if not self._is_far(one, now)]
        ended = [self.fit(one.candidates, one, again=True) for one in near]
        return ended[-1] if ended else None

    def each_without(self, apart: Sequence[Candidate], now: FittedModel) -> Iterator[tuple[Candidate, FittedModel]]:
        """Yield candidates of a model with the fit of the others, the least missed first; those that are asked for are fitted to the end.

        Args:
            apart: Candidates that may each be left out alone.
            now: The model.
        """
        sets = [(now.without(one), now) for one in apart]
        looks = self.fit_all(sets, again=True) if self.cheap else self.threads.fits(lambda one: self.look(one[0], one[1], again=True), sets)
        for candidate, look in sorted(zip(apart, looks, strict=True), key=lambda pair: pair[1].fit.sse):
            ended = self.cheap or self._is_known(look) or self._is_far(look, now)
            yield candidate, look if ended else self.fit(look.candidates, look, again=True)

    def _is_known(self, one: FittedModel) -> bool:
        return self._fitted.get(key_of(one.candidates)) is one

    def _is_far(self, one: FittedModel, aim: FittedModel) -> bool:
        """Return whether a model leaves so much more than another that the last steps of its fit cannot matter."""
        return one.fit.sse > acceptance.FAR_FROM_RIVALLING * aim.fit.sse

    def _starts(
        self, candidates: Sequence[Candidate], near: FittedModel | None
    ) -> tuple[tuple[FreeParameter, ...], list[dict[FreeParameter, float]]]:
        """Return what is free, and the values from which a fit may begin."""
        start = near.fit.values if near else {}
        parameters = (*self.nuisances, *(q for candidate in candidates for q in candidate.parameters))
        begun = {q: start.get(q, q.start) for q in parameters} | self._inherited(candidates, near)
        options = [begun]
        new = [q for q in parameters if q not in start]
        if near and new and (self.cheap or any(q.nonsmooth for q in new)):  # what is missing may have biased the nuisance parameters
            options.append({**begun, **{q: q.prior[0] for q in self.nuisances if q.prior}})
        ended = {q.slot: value for q, value in start.items()}
        for candidate in candidates:
            if any(q not in start for q in candidate.parameters):
                promised = self.promised.get(candidate.key)
                own = candidate.starts if promised is None else (*candidate.starts, promised)
                if any(q.slot in ended for q in candidate.parameters):  # what the model has of the same numbers already
                    own = (*own, _as_ended(candidate, ended))
                options = [{**o, **dict(zip(candidate.parameters, values, strict=True))} for o in options for values in own]
                options += [candidate.beside(option) for option in options if candidate.displaced]
        return parameters, options

    def _inherited(self, candidates: Sequence[Candidate], near: FittedModel | None) -> dict[FreeParameter, float]:
        """Return where nuisance parameters begin whose number a candidate of a similar model held that is left out: where it held it."""
        held = {q.slot: near.fit.values[q] for c in near.candidates for q in c.parameters} if near else {}
        taken = {q.slot for c in candidates for q in c.parameters}
        return {q: min(max(held[q.slot], q.low), q.high) for q in self.nuisances if q.slot in held and q.slot not in taken}

    def _best_start(
        self, residual: Residual, options: Sequence[dict[FreeParameter, float]]
    ) -> tuple[dict[FreeParameter, float], float, list[int]]:
        """Return the start that leaves least, the correlation length of what it leaves, and the order of all starts."""
        errors = [residual(option) for option in options]
        order = [int(i) for i in np.argsort([float(e @ e) if np.isfinite(e).all() else np.inf for e in errors])]
        return options[order[0]], min(self.correlation_time(errors[order[0]]), acceptance.LONGEST_CORRELATION), order

    def _not_astray(
        self, residual: Residual, begin: dict[FreeParameter, float], candidates: Sequence[Candidate], near: FittedModel | None
    ) -> dict[FreeParameter, float]:
        """Return a start at which new candidates do less where at their own far more is left than without them.

        What a similar model has settled on may answer to a usual size of another effect by a hundred times what it leaves. From there a
        linear step, which moves all together, does not come back; from a smaller size it does.
        """
        if near is None or not near.fit.residual.size:
            return begin
        new = [c for c in candidates if c.proportional and not c.is_law and not any(q in near.fit.values for q in c.parameters)]
        if not new:
            return begin
        for share in (REDUCED**k for k in range(MOST_REDUCED + 1)):
            start = {**begin, **{q: v for c in new for q, v in in_proportion({q: begin[q] for q in c.parameters}, share).items()}}
            error = residual(start)
            if float(error @ error) <= STRAY * near.fit.sse:  # not so where it is not a number
                return start
        return begin

    def _furthest_led(
        self,
        residual: Residual,
        parameters: Sequence[FreeParameter],
        options: Sequence[dict[FreeParameter, float]],
        length: float,
        columns: Mapping[FreeParameter, Array] | None,
    ) -> dict[FreeParameter, float]:
        """Return where the first steps lead furthest, of those from several starts, best first.

        How a law goes on may be felt only beyond a size: of a hose that is shorter than a wave takes to be seen, nothing says how long.
        """
        if len(options) < 2 or self.is_spent():
            return options[0]
        looks = [self._first_steps(residual, parameters, option, length, columns) for option in options[:LAW_STARTS]]
        return min(looks, key=_cost).values

    def _first_steps(
        self, residual: Residual, parameters: Sequence[FreeParameter], begin: dict[FreeParameter, float], length: float,
        columns: Mapping[FreeParameter, Array] | None,
    ) -> Fit:  # fmt: skip
        """Return a fit after the first steps that are worth it, with known derivatives where there are some."""
        return fit(
            residual, parameters, begin, self.threads, max_iterations=FIRST_LOOK, tolerance=WORTH_A_LOOK, correlation_length=length,
            derivatives=Derivatives(columns, renewed=False), is_spent=self.is_spent,
        )  # fmt: skip

    def _fit_cheaply(
        self,
        residual: Residual,
        parameters: Sequence[FreeParameter],
        options: Sequence[dict[FreeParameter, float]],
        length: float,
    ) -> Fit:
        """Return the best of several fits, from scratch; `options` are the starts, best first."""
        def tried_from(start: dict[FreeParameter, float], length: float) -> Fit:
            return fit(
                residual, parameters, start, self.threads,
                max_iterations=24, tolerance=1e-5, correlation_length=length, is_spent=self.is_spent,
            )  # fmt: skip

        tried = [tried_from(start, length) for start in options[: 1 if self.is_spent() else CHEAP_STARTS]]
        done = min(tried, key=_cost)
        missing = done.sse - self.model.size
        if length > acceptance.STIFF_PRIORS and missing > self.model.size:
            free = tried_from(options[0], 1.0)
            done = free if free.sse - self.model.size < acceptance.LEFT_WHEN_FREE * missing else done
        return done

    def fit_all(self, asked: Sequence[tuple[Sequence[Candidate], FittedModel]], again: bool = False) -> list[FittedModel]:
        """Fit several sets in parallel, each from a similar model; a set that is asked for twice is started from the first one's."""
        first = {key_of(candidates): (candidates, near) for candidates, near in reversed(asked)}
        fitted = dict(zip(first, self.threads.fits(lambda one: self.fit(one[0], one[1], again), list(first.values())), strict=True))
        return [fitted[key_of(candidates)] for candidates, _ in asked]

    def refined(self, model: FittedModel) -> FittedModel:
        """Return a model fitted to convergence, with an exact Jacobian: its values are going to be reported."""
        known = Derivatives(model.fit.columns, exact=True, differenced_at=model.fit.differenced_at)
        return self._gone_on(model, known, CONVERGED)

    def carried_on(self, model: FittedModel) -> FittedModel:
        """Return a model whose fit goes on until a step gains little, its Jacobian about where it ends: others begin there."""
        return self._gone_on(model, Derivatives(model.fit.columns, differenced_at=model.fit.differenced_at))

    def _gone_on(self, model: FittedModel, known: Derivatives, tolerance: float = TOLERANCE) -> FittedModel:
        """Return a model whose fit goes on from where it is, which is kept in its place."""
        if not model.fit.residual.size:
            return model
        parameters = (*self.nuisances, *(q for candidate in model.candidates for q in candidate.parameters))
        better = FittedModel(model.candidates, self._fit_from(model, parameters, known, tolerance))
        self._fitted[key_of(model.candidates)] = better
        return better

    def refitted_without(self, model: FittedModel, gone: Collection[FreeParameter]) -> Fit:
        """Return the fit of a model in which some nuisance parameters stay at their nominal values, started from it.

        Args:
            model: Fitted, with its Jacobian.
            gone: What is held.
        """
        parameters = tuple(q for q in model.fit.parameters if q not in gone)
        return self._fit_from(model, parameters, Derivatives(model.fit.columns, renewed=False), CONVERGED)

    def fit_holding(self, model: FittedModel, held: Values) -> FittedModel:
        """Return a model fitted anew, started from itself, with some of its parameters held at these values."""
        parameters = tuple(q for q in model.fit.parameters if q not in held)
        done = self._fit_from(model, parameters, Derivatives(model.fit.columns), TOLERANCE, held)
        return FittedModel(model.candidates, replace(done, values={**done.values, **held}))

    def _fit_from(
        self, model: FittedModel, parameters: Sequence[FreeParameter], known: Derivatives, tolerance: float,
        held: Values = MappingProxyType({}),
    ) -> Fit:  # fmt: skip
        """Return the fit of these parameters of a model, begun where it is, others `held` at values of theirs."""
        length = min(self.correlation_time(model.fit.residual), acceptance.LONGEST_CORRELATION)
        residual = self._residual_of(model.candidates)
        done = fit(
            lambda values: residual({**values, **held}), parameters, model.fit.values, self.threads, max_iterations=MOST_STEPS,
            tolerance=tolerance, correlation_length=length, derivatives=known, is_spent=self.is_spent,
        )  # fmt: skip
        return with_common_parts_split(done)

    def _residual_of(self, candidates: Sequence[Candidate]) -> Residual:
        fixed = [pair for candidate in candidates for pair in candidate.fixed]
        return lambda values: self.model.residual(values, fixed)

    def correlation_time(self, residual: Array) -> float:
        """Return the integrated autocorrelation time of a residual, in rows."""
        return correlation_time(residual, self.model.blocks)

    def standard_errors(self, fitted: FittedModel) -> dict[FreeParameter, float]:
        """Return the standard error of every parameter of a fitted model, in its unit.

        How late the card of the pressures is shows only together with how early the position may be: its error is that of the sum.
        """
        errors = standard_errors(self.model, fitted.fit, self.correlation_time(fitted.fit.residual))
        own = {q.parameter: q for q in errors}
        if CARD_OF_PRESSURES in own and own.get(POSITION_DELAY) in self.nuisances:
            card = own[CARD_OF_PRESSURES]
            errors[card] = self.error_of_sum(fitted, {card: 1.0, own[POSITION_DELAY]: -1.0})
        return errors

    def error_of_sum(self, fitted: FittedModel, weights: Mapping[FreeParameter, float]) -> float:
        """Return the standard error of a weighted sum of parameters of a fitted model; infinite where one of them was not fitted."""
        return error_of_sum(self.model, fitted.fit, self.correlation_time(fitted.fit.residual), weights)

    def effective_sample_size(self, models: Sequence[FittedModel]) -> float:
        """Return the number of independent rows in the residual of the best of these models."""
        best = min(models, key=lambda model: model.fit.sse)
        return self.model.size / self.correlation_time(best.fit.residual)

    def deficit(self, one: FittedModel, other: FittedModel) -> float:
        """Return by how much one model's log-likelihood is lower than another's, on the independent rows of the better one."""
        rows = self.effective_sample_size((one, other))
        return negative_log_likelihood(one.fit, rows) - negative_log_likelihood(other.fit, rows)
