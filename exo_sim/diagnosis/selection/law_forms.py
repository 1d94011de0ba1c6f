"""The forms that the laws of a fitted model may have, each fitted as it acts.

Subsets are weighed over a grid of shapes. Where a recording is quiet, the nearest shape of the grid leaves more than the noise, and a law
with one number more makes up for it: the law that the machine follows may look improbable until its shape is fitted.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from exo_sim.diagnosis.estimation.candidate import Candidate, CandidateKey
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.policy import verdicts
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.laws import Law


@dataclass(frozen=True)
class FittedForm:
    """A model in one form of its laws, and the logarithm of its evidence, parameters paid for."""

    model: FittedModel
    log_evidence: float


def fitted_forms(
    model: FittedModel, forms: Sequence[Candidate], fit: Callable[[tuple[Candidate, ...], FittedModel], FittedModel],
    evidence: Callable[[FittedModel], float],
) -> list[FittedForm]:  # fmt: skip
    """Return a model with its effects in each of their forms that differ in nothing but the shape of a law; itself first.

    Args:
        model: The model.
        forms: All candidates.
        fit: Fits candidates, begun near another model.
        evidence: The logarithm of a fitted model's evidence.
    """
    options = [(c, *(form for form in forms if _differs_in_shape(c, form))) for c in model.candidates]
    sets = list(itertools.product(*options))
    shapes = {q: q.start for chosen in options for c in chosen for q in c.parameters if q.is_shape}
    near = FittedModel.at({**shapes, **model.fit.values})  # a shape that is new begins as the plain law has it
    return [FittedForm(one, evidence(one)) for one in (model, *(fit(chosen, near) for chosen in sets[1:]))]


def plainest(found: Sequence[FittedForm]) -> FittedModel:
    """Return the form with the fewest parameters, unless the evidence for one with more is very strong: linear, if that will do."""
    most = max(one.log_evidence for one in found)
    good = [one for one in found if most - one.log_evidence <= verdicts.SHAPE_NEEDED]
    return min(good, key=lambda one: (one.model.parameter_count, -one.log_evidence)).model


def as_fitted(model: FittedModel, errors: Mapping[FreeParameter, float]) -> Law:
    """Return the law of a model that was fitted as it acts.

    Args:
        model: The model.
        errors: Its standard errors.
    """
    return Law(1.0, True, model.fit.values, errors, _form(model))


def weighed_as_fitted(
    laws: Sequence[Law], found: Sequence[FittedForm], final: FittedModel, errors: Callable[[FittedModel], Mapping[FreeParameter, float]]
) -> list[Law]:
    """Return laws of which those of the model's own effects are the fitted forms, by their evidence; together as probable as before.

    Laws beside other effects become as much less probable as the form of the model's effects under them was found to be.

    Args:
        laws: Over the grid, and beside other effects.
        found: The fitted forms; where there is one alone the laws stay as they are.
        final: Which of them is the model.
        errors: Standard errors of a fitted model.
    """
    if len(found) < 2:
        return list(laws)
    own = {c.at for c in final.candidates if not c.is_law}

    def is_alone(law: Law) -> bool:
        return {key[:2] for key in law.forms} == own

    alone = [law for law in laws if is_alone(law)]
    mass = sum(law.weight for law in alone)
    weighed = {one.forms: sum(law.weight for law in alone if law.forms == one.forms) / mass for one in alone}
    models = {_form(one.model): one for one in found}
    most = max(one.log_evidence for one in found)
    weights = {form: math.exp(one.log_evidence - most) for form, one in models.items()}
    fitted = {form: weight / sum(weights.values()) for form, weight in weights.items()}

    def beside_others(law: Law) -> Law:
        form = frozenset(key for key in law.forms if key[:2] in own)
        fewer = min(fitted.get(form, 0.0) / weighed[form], 1.0) if form in weighed else 1.0
        return replace(law, weight=law.weight * fewer)

    beside = [beside_others(law) for law in laws if not is_alone(law)]
    return [law for law in beside if law.weight >= verdicts.LEAST_LAW_WEIGHT] + [
        Law((mass or 1.0) * fitted[form], one.model is final, one.model.fit.values, errors(one.model), form)
        for form, one in models.items() if fitted[form] >= verdicts.LEAST_LAW_WEIGHT
    ]  # fmt: skip


def _form(model: FittedModel) -> frozenset[CandidateKey]:
    return frozenset(c.key for c in model.candidates if not c.is_law)


def _differs_in_shape(one: Candidate, other: Candidate) -> bool:
    """Return whether two candidates are one effect in forms of which one has numbers more that only shape its law."""
    apart = set(one.parameters) ^ set(other.parameters)
    return one.at == other.at and bool(apart) and all(q.is_shape for q in apart)
