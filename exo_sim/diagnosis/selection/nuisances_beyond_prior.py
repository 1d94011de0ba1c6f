"""Numbers of the rig that a fit moved further than any data sheet allows: what they stand for is asked once more with them held within it.

A search refits them beside every effect, and physics that looks like one of them is never missed: a hose is a larger dead volume, a slow
spool the lag that every valve has. Held within its data sheet such a number leaves the error that it took, and what is declared to be
mistaken for it is asked beside that.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TypeVar

import numpy as np

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.estimation.correlation import rms
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.prior_terms import as_counted
from exo_sim.diagnosis.estimation.uncertainty import covariance
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.nominal_numbers import CARD_OF_PRESSURES, POSITION_DELAY
from exo_sim.diagnosis.policy.acceptance import SURELY_MORE
from exo_sim.diagnosis.policy.off_nominal import FAR_FROM_STRAINED, WORTH, WRONG_NUMBER
from exo_sim.diagnosis.policy.verdicts import AS_GOOD, STRAINED
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult, exceeds_healthy_limit, is_at_bound
from exo_sim.diagnosis.selection.further_forms import in_further_form
from exo_sim.diagnosis.selection.held_numbers import Held, is_at_end, ways_to_hold
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.proposals import Proposals
from exo_sim.diagnosis.selection.quantity_parts import Limits, healthy_limits, parts_of, together, weights_of
from exo_sim.diagnosis.selection.shape_scan import best_shapes
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.physics.declaration import declared

Model = TypeVar("Model", bound=SubsystemModel)


def is_beyond_data_sheet(parameter: FreeParameter, value: float, error: float) -> bool:
    """Return whether a number is surely further from what is believed than its data sheet allows, or as far as it may go at all.

    Args:
        parameter: A nuisance parameter with a prior.
        value: Of a fit.
        error: Its standard error.
    """
    if parameter.prior is None:
        return False
    mean, spread = parameter.prior
    return abs(value - mean) - SURELY_MORE * error > STRAINED * spread or is_at_end(parameter, value)


def strained(model: FittedModel, fits: ModelFits, limits: Limits = MappingProxyType({})) -> tuple[FreeParameter, ...]:
    """Return the numbers of the rig, and what healthy parts show, that a fit moved beyond any data sheet.

    Of sensors only how late cards are: errors of the model move zeros. Nor an owner's numbers of an effect, whose law may differ. Parts of
    one quantity (dead time and time constant of a lag) are also judged together, by `limits`: a fit may share out what neither could be.

    Args:
        model: Fitted.
        fits: That it is one of.
        limits: How much of a quantity is healthy.
    """
    values, errors = model.fit.values, fits.standard_errors(model)
    own = [q for q in values if _is_of_a_part(q) and not _is_overridden(q, model)]
    beyond = [q for q in own if is_beyond_data_sheet(q, as_counted(q, values), errors.get(q, math.inf))]
    for quantity, limit in limits.items():
        parts = parts_of(quantity, own)
        if len(parts) > 1 and together(parts, values) > limit:
            error = fits.error_of_sum(model, weights_of(parts, values))
            beyond += parts if together(parts, values) - SURELY_MORE * error > limit else ()
    return tuple(q for q in own if q in beyond)


def relieved(search: SearchResult, fits: ModelFits, proposals: Proposals, model: Model, split: Split) -> tuple[SearchResult, ModelFits]:
    """Return a search whose strained numbers gave way to effects that explain as much with them held within their data sheets.

    Such an effect is accepted against the model with the numbers held, as any other is; it must also leave no more than the strained
    numbers do, nor in held-out time. Where the numbers by themselves are as probable, the finding says so; where they are more so, or no
    effect does all that, the search stays as it is, but for what they may stand for. So it is where the search found such an effect itself.

    Args:
        search: What was found with the numbers free.
        fits: The fits of that search.
        proposals: Its candidates.
        model: The subsystem.
        split: Of the time, its validation time held out.

    Returns:
        The search, and the fits that its final model belongs to.
    """
    asked_already, limits = set[str](), healthy_limits(proposals.candidates)
    while not search.interrupted and search.final.fit.residual.size and not fits.is_spent():
        pressed = [q for q in strained(search.final, fits, limits) if q.effect not in asked_already]
        if not pressed:
            break
        effect = pressed[0].effect
        asked_already.add(effect)
        together = tuple(q for q in pressed if q.effect == effect)
        search, fits = _relieved_of(together, search, fits, proposals, model, split, limits)
    comparisons = Comparisons(fits, search.baseline, len(proposals.candidates), model.practical_significance)
    return (search if search.interrupted or fits.is_spent() else _with_numbers_as_rivals(search, fits, comparisons)), fits


def absorbers(pressed: Sequence[FreeParameter], now: FittedModel, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return the candidates that some strained numbers may stand for: declared to be mistaken for them, or of these very numbers.

    A law is asked only of the latter: how every machine follows it was fitted within what healthy machines show, whether or not what it
    otherwise comes on top of is there.

    Args:
        pressed: The numbers, of one effect or calibration.
        now: The model that they are strained in.
        candidates: All of the subsystem.
    """
    names, slots = {q.effect for q in pressed}, {q.slot for q in pressed}
    card = any(q.parameter == POSITION_DELAY for q in pressed)  # pressures and position are late as each other is early
    found = []
    for c in candidates:
        same = bool(slots & {q.slot for q in c.parameters}) or (card and any(q.parameter == CARD_OF_PRESSURES for q in c.parameters))
        alike = c.kind is Kind.MISSING_PHYSICS and c.effect in declared() and bool(names & set(declared()[c.effect].mistaken_for))
        if c.at in now.named:
            continue
        if c.is_law and same:
            found.append(replace(c, prerequisite="" if not now.meets_prerequisite(c) else c.prerequisite))
        elif not c.is_law and (same or alike) and now.meets_prerequisite(c):
            found.append(c)
    return found


def _relieved_of(
    pressed: tuple[FreeParameter, ...], search: SearchResult, fits: ModelFits, proposals: Proposals, model: Model, split: Split,
    limits: Limits,
) -> tuple[SearchResult, ModelFits]:  # fmt: skip
    final = search.final
    asked = absorbers(pressed, final, proposals.candidates)
    if not asked:
        return search, fits
    within, bounded, near, held = _held(pressed, final, fits, limits)
    own = _own(pressed, final, asked)
    alone = bounded.fit((*final.candidates, own), _at_prior_means(near, within.bounded.values()))
    comparisons = Comparisons(bounded, search.baseline, len(proposals.candidates), model.practical_significance)
    looked = bounded.fit_rivals([((*final.candidates, c), near) for c in asked], alone)
    looked += _begun_at_shapes(asked, bounded.fit(final.candidates, near), bounded)
    tried = [bounded.refined(one) for one in looked if one.fit.sse < (1.0 + FAR_FROM_STRAINED) * alone.fit.sse]
    kept_back = model.on_test_time(split.validation_as_test()) if split.validation else None

    def stands(one: FittedModel) -> bool:
        candidate = one.candidates[-1]
        gives_way = not within.is_at_end([q for q in within.bounded.values() if not _is_overridden(q, one)], one.fit.values)
        found = exceeds_healthy_limit(candidate, one, bounded.standard_errors(one)) and not is_at_bound(candidate, one)
        return gives_way and found and comparisons.accepts(held, one) and _explains_as_well(one, alone, model, kept_back)

    standing = [one for one in tried if stands(one)]
    if not standing:
        return search, fits
    best, *others = comparisons.ranked(standing)
    chosen = best.candidates[-1]
    by_itself = _worse(alone, best, own, chosen, comparisons)
    if own.effect != chosen.effect and by_itself < 0.0:
        alike = dict.fromkeys(one.candidates[-1].effect for one in (best, *others) if -by_itself < AS_GOOD)
        return replace(search, stands_for={**search.stands_for, (own.effect, own.where): tuple(alike)}), fits
    best = _gone_on(best, bounded, comparisons, proposals)
    chosen = best.candidates[-1]
    losses = [(one.candidates[-1], max(_worse(one, best, one.candidates[-1], chosen, comparisons), 0.0)) for one in others]
    losses += [(own, by_itself)] if own.effect != chosen.effect else []
    evidence = {**search.evidence, chosen.key: comparisons.evidence(held, best)}
    rivals = {**search.rivals, chosen.key: _sorted((c, worse) for c, worse in losses if c.at != chosen.at)}
    return replace(search, final=best, evidence=evidence, rivals=rivals), bounded


def _gone_on(best: FittedModel, bounded: ModelFits, comparisons: Comparisons, proposals: Proposals) -> FittedModel:
    """Return a model with its last finding in the form in which its law goes on, where something is left and the data support one.

    The search could not ask: there it was numbers that healthy machines have.
    """
    if comparisons.is_clean(best):
        return best
    further = in_further_form(best.candidates[-1], best, bounded, comparisons, proposals)
    return best if further is best else bounded.refined(further)


def _held(
    pressed: Sequence[FreeParameter], final: FittedModel, fits: ModelFits, limits: Limits
) -> tuple[Held, ModelFits, FittedModel, FittedModel]:
    """Return how numbers are held while effects are asked, the fits with them so, where such a fit begins, and the model with them held.

    Effects are asked beside what is healthy, shared out nearly as it was; the model that they are held against is that of the way that
    leaves least, for however a quantity is shared it is healthy.
    """
    known = covariance(final.fit, fits.correlation_time(final.fit.residual))
    at = [final.fit.parameters.index(q) for q in pressed]
    units = np.array([q.slope(final.fit.values[q]) for q in pressed])
    tried = []
    for within in ways_to_hold(pressed, final.fit.values, known[np.ix_(at, at)] * np.outer(units, units), limits):
        nuisances = [within.bounded.get(q, q) for q in fits.nuisances]
        bounded = ModelFits(fits.model, nuisances, fits.threads, fits.cheap, fits.is_spent)
        near = _of_parameters(final, within.bounded)
        tried.append((within, bounded, near, bounded.fit(final.candidates, near)))
    least = tried[0][-1]
    for *_, other in tried[1:]:
        least = other if fits.deficit(other, least) < 0.0 else least
    return *tried[0][:-1], least


def _begun_at_shapes(asked: Sequence[Candidate], held: FittedModel, bounded: ModelFits) -> list[FittedModel]:
    """Return the fits of candidates whose answer is not in proportion, each begun at the best shape beside numbers that are held.

    With the numbers free the shape hardly shows: they took what it explains.
    """
    begun = best_shapes(bounded.model, held, asked, bounded.threads, bounded.is_spent)
    return bounded.fit_all([(one.candidates, one) for _, one in begun], again=True)


def _with_numbers_as_rivals(search: SearchResult, fits: ModelFits, comparisons: Comparisons) -> SearchResult:
    """Return a search in which numbers of the rig that an effect takes a part of are rivals of it where they alone explain as much."""
    final, rivals = search.final, dict(search.rivals)
    for c in final.candidates:
        taken = {key: per_unit * final.fit.values[q] for q, key, per_unit in c.displaced}
        numbers = tuple(q for q in fits.nuisances if q.key in taken)
        if not numbers or any(own.effect == numbers[0].effect for own, _ in rivals.get(c.key, ())):
            continue
        own = replace(_own(numbers, final), starts=(tuple(1.0 + taken[q.key] for q in numbers),))
        alone = fits.fit(drop_orphans([*final.without(c), own]), final)
        rivals[c.key] = _sorted([*rivals.get(c.key, ()), (own, max(_worse(alone, final, own, c, comparisons), 0.0))])
    return replace(search, rivals=rivals)


def _worse(one: FittedModel, best: FittedModel, rival: Candidate, chosen: Candidate, comparisons: Comparisons) -> float:
    """Return by how much less probable one model is than another, in log-probability: parameters, and how usual both are, paid for."""
    price = comparisons.price((one, best)) * (one.parameter_count - best.parameter_count)
    return comparisons.fits.deficit(one, best) + price + math.log(chosen.prevalence / rival.prevalence)


def _sorted(rivals: Iterable[tuple[Candidate, float]]) -> tuple[tuple[Candidate, float], ...]:
    return tuple(sorted(rivals, key=lambda pair: pair[1]))


def _explains_as_well(one: FittedModel, other: FittedModel, model: Model, kept_back: SubsystemModel | None) -> bool:
    """Return whether a model leaves no more than another in the time that was fitted and in held-out time, but for what is too little
    to matter.
    """
    slack = model.practical_significance
    if rms(one.fit.residual) - rms(other.fit.residual) > slack:
        return False
    if kept_back is None or not kept_back.size:
        return True
    left = [kept_back.residual(m.fit.values, m.fixed) for m in (one, other)]
    return bool(np.isfinite(left[0]).all()) and rms(left[0]) - rms(left[1]) <= slack


def _own(pressed: Sequence[FreeParameter], final: FittedModel, asked: Sequence[Candidate] = ()) -> Candidate:
    """Return the candidate that the strained numbers by themselves are.

    What healthy parts show of an effect ends where no healthy part's is: of more of it the effect itself says how far it may go.

    Args:
        pressed: The numbers.
        final: The model that they are strained in.
        asked: Candidates, of which one may be of these very numbers.
    """
    first, form = pressed[0], "+".join(q.parameter for q in pressed)
    fitted = {q.slot: value for q, value in final.fit.values.items()}
    values = tuple(final.fit.values[q] for q in pressed)
    for c in (c for c in asked if c.at == (first.effect, first.where)):
        if c.form == form or (c.is_law and all(q.slot in fitted for q in c.parameters)):
            return replace(c, starts=(*c.starts, tuple(fitted[q.slot] for q in c.parameters)))
    free = tuple(replace(q, prior=None) for q in pressed)
    return Candidate(first.effect, first.where, form, free, (values,), kind=Kind.CALIBRATION, prevalence=float(WRONG_NUMBER))


def _of_parameters(model: FittedModel, instead: Mapping[FreeParameter, FreeParameter]) -> FittedModel:
    """Return a model with other bounds of some parameters, for a fit to begin with."""
    fit = model.fit
    parameters = tuple(instead.get(q, q) for q in fit.parameters)
    values = {instead.get(q, q): v for q, v in fit.values.items()}
    return replace(model, fit=replace(fit, parameters=parameters, values=values))


def _at_prior_means(model: FittedModel, parameters: Collection[FreeParameter]) -> FittedModel:
    means = {q: q.prior[0] for q in parameters if q.prior is not None}
    return replace(model, fit=replace(model.fit, values={**model.fit.values, **means}))


def _is_of_a_part(q: FreeParameter) -> bool:
    """Return whether a nuisance parameter is a number of the rig, what a healthy part shows of an effect, or how late a card is."""
    if q.prior is None:
        return False
    return q.effect in WORTH or (q.effect in declared() and q.prior[0] == 0.0) or q.parameter == POSITION_DELAY


def _is_overridden(q: FreeParameter, model: FittedModel) -> bool:
    """Return whether an effect of a model holds the very number that a nuisance parameter stands for."""
    return q.slot in {own.slot for c in model.candidates for own in c.parameters}
