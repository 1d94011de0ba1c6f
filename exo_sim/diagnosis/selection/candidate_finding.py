"""What is stated of a candidate that stands: its numbers with their intervals, its odds, and the effects that explain as much."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.estimation.uncertainty import bounded_interval
from exo_sim.diagnosis.findings import Estimate, Finding
from exo_sim.diagnosis.policy import verdicts
from exo_sim.diagnosis.policy.off_nominal import GAIN_SHARE, MODEL_SHARE, WORTH
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nuisance_calibration import is_declared
from exo_sim.physics.declaration import identification_of

#: How a parameter of a sensor is called in a finding.
_SENSOR_PARAMETERS = {"bias": "value", "scale": "factor", "delay": "seconds"}


def finding_of(candidate: Candidate, final: FittedModel, errors: Mapping[FreeParameter, float], search: SearchResult) -> Finding:
    """Return a candidate that stands as a finding, with its intervals, its odds and the rivals that explain as much.

    Args:
        candidate: Of the final model.
        final: The final model.
        errors: Standard errors of its parameters.
        search: Where it was found.
    """
    estimates = {}
    for parameter in candidate.parameters:
        value = final.fit.values[parameter]
        low, high = _ends(parameter, value, errors.get(parameter, 0.0), search)
        if is_declared(candidate.effect):
            low, high = _widened_by_law(candidate, parameter, low, high, final)
        estimates[_called(parameter)] = Estimate(value, parameter.unit, low, high)
    evidence = search.evidence.get(candidate.key)
    rivals = [
        (rival, worse)
        for rival, worse in search.rivals.get(candidate.key, [])
        if worse <= verdicts.AS_GOOD and rival.effect != candidate.effect
    ]
    weights = {candidate.effect: 1.0, **{r.effect: math.exp(-max(worse, 0.0)) for r, worse in reversed(rivals)}}
    total = sum(weights.values())
    return Finding(
        candidate.effect, candidate.where, candidate.kind, wording.says(candidate.effect), estimates,
        evidence.log10_odds if evidence else 0.0, 0.0, tuple(dict.fromkeys(r.effect for r, _ in rivals)),
        {name: weight / total for name, weight in weights.items()} if rivals else {},
        probability=search.probabilities.get(candidate.at), also=candidate.also,
    )  # fmt: skip


def with_openness_of_law(finding: Finding, candidate: Candidate, search: SearchResult, own: Mapping[FreeParameter, float]) -> Finding:
    """Return a finding that says which ends of its intervals are those of other laws, which explain the recording about as well.

    Args:
        finding: Of a candidate.
        candidate: The same.
        search: Where it was found.
        own: Standard errors that the fit alone has.
    """
    said = {}
    for parameter in candidate.parameters:
        alone = max(own.get(parameter, 0.0), MODEL_SHARE * abs(finding.parameters[_called(parameter)].value))
        ends = zip(("lower", "upper"), search.reach.get(parameter, (0.0, 0.0)), strict=True)
        far = [end for end, reach in ends if reach > verdicts.SET_BY_LAWS * alone > 0.0]
        if far:
            said[_called(parameter)] = far
    return replace(finding, says=f"{finding.says} {wording.set_by_laws(said)}") if said else finding


def with_all_parts(finding: Finding, candidate: Candidate, search: SearchResult, fits: ModelFits) -> Finding:
    """Return a finding whose intervals also cover its parameters in the model that has all parameters of the effect."""
    whole = search.complete.get(candidate.key)
    if whole is None:
        return finding
    errors = fits.standard_errors(whole)
    estimates = dict(finding.parameters)
    for parameter, value in whole.fit.values.items():
        own = estimates.get(parameter.parameter)
        at = (parameter.effect, parameter.where)
        if own is not None and at == finding.at and parameter in whole.effect_parameters:
            low, high = bounded_interval(parameter, value, errors.get(parameter, 0.0))
            estimates[parameter.parameter] = replace(own, low=min(own.low, low), high=max(own.high, high))
    return replace(finding, parameters=estimates)


def _ends(parameter: FreeParameter, value: float, error: float, search: SearchResult) -> tuple[float, float]:
    """Return the ends of a parameter's interval: as wide as laws differ, and as far as one lies; nil is reached by laws on that side alone.

    No law is the machine's own: by how much they differ it may differ from them to either side.
    """
    least, nil = GAIN_SHARE * abs(value), parameter.neutral
    low, high = bounded_interval(parameter, value, max(error, least))
    if error > search.errors.get(parameter, 0.0):  # the fit itself knows less
        return low, high
    below, above = search.reach.get(parameter, (error, error))
    lowest = bounded_interval(parameter, value, max(below, least))[0]
    highest = bounded_interval(parameter, value, max(above, least))[1]
    low = lowest if low <= nil < value else min(low, lowest)
    return low, highest if value < nil <= high else max(high, highest)


def _widened_by_law(
    candidate: Candidate, parameter: FreeParameter, low: float, high: float, final: FittedModel
) -> tuple[float, float]:
    """Return the ends of an interval widened by what the law itself leaves open.

    A form with more of the law leaves less open, and so does another effect at its place that says the rest of it, found or the rig's.
    """
    asked = identification_of(candidate.effect)
    if asked.closed_by and asked.closed_by in {q.parameter for q in candidate.parameters}:
        return low, high
    beside = (*final.fit.values, *(q for q, _ in final.fixed))
    if asked.closed_beside and any((q.effect, q.where) == (asked.closed_beside, candidate.where) for q in beside):
        return low, high
    down, up = asked.open_by.get(parameter.parameter, (1.0, 1.0))
    return max(low * down, parameter.low), min(high * up, parameter.high)


def with_what_it_counts_from(finding: Finding, final: FittedModel) -> Finding:
    """Return a finding that says what its numbers count from where that is not what the rig says: a number that was fitted beside them."""
    said = []
    for name, words in identification_of(finding.name).counts_from.items():
        factor = next((value for q, value in final.fit.values.items() if (q.effect, q.where) == (name, finding.where)), 1.0)
        if (name, finding.where) in final.named or (name in WORTH and abs(factor - 1.0) >= WORTH[name]):
            said.append(words.format(wording.more_or_less(factor)))
    return replace(finding, says=" ".join([finding.says, *said])) if said else finding


def with_twins(finding: Finding, twins: Sequence[str]) -> Finding:
    """Return a finding that names its twins beside its rivals, all equally probable."""
    for twin in twins:
        if twin not in finding.ambiguous_with:
            names = (finding.name, *finding.ambiguous_with, twin)
            finding = replace(
                finding, ambiguous_with=(*finding.ambiguous_with, twin), probabilities=dict.fromkeys(names, 1.0 / len(names))
            )
    return finding


def _called(parameter: FreeParameter) -> str:
    """Return how a parameter is called in a finding."""
    if parameter.target is not Target.SENSOR:
        return parameter.parameter
    name = parameter.parameter.rsplit(".", 1)[-1]
    return _SENSOR_PARAMETERS.get(name, name)
