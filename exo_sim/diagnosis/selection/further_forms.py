"""Effects that were found, in forms in which their law goes on, and by what law they act: asked where something is left, or another would
take a place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.policy import acceptance
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import FittedModel, reach_of_bound
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.proposals import Proposals


def with_further_forms(
    now: FittedModel, fits: ModelFits, comparisons: Comparisons, proposals: Proposals, instead: bool = False
) -> FittedModel:  # fmt: skip
    """Return a model with findings in the further forms and by the laws that the data support; itself where they support none, or nothing
    is left.

    A further form is no other effect: it passes the gates of what stands in a model already, where the poorer one is worse by more than
    chance. How little of all that was missing it adds says nothing there: of an error of 245 times the noise a thousandth is 8 times the
    noise, and that is what it is asked for. It is fitted from each of its starts, for how a law goes on may be felt only beyond a size:
    the waves of a hose stay out of a fit that begins with half its length. A law is asked as well where no more is left than a healthy
    machine leaves, and no further name is sought: what it gets wrong ends in the numbers of what was found.

    Args:
        now, fits, comparisons, proposals: Of the search.
        instead: Whether another effect would take the place of one of them: then they are asked though nothing is left.
    """

    def is_over(now: FittedModel) -> bool:
        return (comparisons.is_clean(now) and not instead) or fits.is_spent()

    for candidate in now.candidates:
        if is_over(now):
            break
        now = in_further_form(candidate, now, fits, comparisons, proposals)
    for law in proposals.laws(now):
        if is_over(now):
            break
        now = _with_best([(law, (*now.candidates, law))], now, fits, comparisons)
    return now


def in_further_form(
    candidate: Candidate, now: FittedModel, fits: ModelFits, comparisons: Comparisons, proposals: Proposals
) -> FittedModel:  # fmt: skip
    """Return a model with one of its findings in the further form that the data support; itself where they support none."""
    forms = proposals.further(candidate, now)
    return _with_best([(one, tuple(one if c is candidate else c for c in now.candidates)) for one in forms], now, fits, comparisons)


def _with_best(
    forms: Sequence[tuple[Candidate, tuple[Candidate, ...]]], now: FittedModel, fits: ModelFits, comparisons: Comparisons
) -> FittedModel:
    """Return the best of a model and those of other forms that are accepted in its place, each form with the set that it is in."""
    shown = []
    for form, chosen in forms:
        begun = [replace(form, starts=(start,)) for start in form.starts]
        model = fits.fit_from_each([tuple(one if c is form else c for c in chosen) for one in begun], now)
        if model is None or fits.deficit(now, model) < acceptance.NO_WORSE or _is_at_end(form, model):
            continue
        if comparisons.accepts(now, model, stands=True):
            shown.append(model)
    return comparisons.ranked([now, *shown])[0]


def _is_at_end(form: Candidate, model: FittedModel) -> bool:
    """Return whether something by which a law goes on ended at a bound: it was not found."""
    parameters = [q for q in form.parameters if q.parameter in form.further]
    ends = [(q, model.fit.values[q]) for q in parameters]
    return any(min(value - q.low, q.high - value) < reach_of_bound(q, value) for q, value in ends)
