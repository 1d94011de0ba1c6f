"""What is said of a finished search: the evidence for each finding, its rivals, and the candidates that were left."""

from __future__ import annotations

from exo_sim.diagnosis.estimation.candidate import Candidate, CandidateKey, drop_orphans
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy import acceptance
from exo_sim.diagnosis.policy.budgets import RUNNERS_UP
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.indistinguishable_effects import indistinguishable_effects
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.proposals import Proposals, is_declared_alike


def assess(final: FittedModel, fits: ModelFits, comparisons: Comparisons, proposals: Proposals, spent: bool = False) -> SearchResult:
    """Compare each finding with leaving it out and with what could take its place; beside few findings also with one more.

    Where the time is spent nothing is fitted in the place of a finding, nor beside all of them.
    """
    evidence, rivals, complete = {}, {}, {}
    asked: list[tuple[Candidate, Candidate, FittedModel]] = []
    bare = fits.fit_rivals([(drop_orphans(final.without(candidate)), final) for candidate in final.candidates], final)
    for candidate, without in zip(final.candidates, bare, strict=True):
        evidence[candidate.key] = comparisons.evidence(without, final)
        asked += [(candidate, rival, without) for rival in ([] if spent else _rivals(candidate, without, final, proposals))]
    for candidate in (c for c in final.candidates if c.additive and not fits.is_spent()):
        whole = _with_all_parameters(candidate, final, fits, proposals)
        if whole is not None:
            complete[candidate.key] = whole
    is_settled = spent or final.is_large
    promised = {} if is_settled else {one.key: score for score, one in proposals.scored(final)}
    runners_up: list[tuple[Candidate, float]] = []
    for one in [] if is_settled else proposals.alternatives(final, RUNNERS_UP):
        if proposals.promise_enough(promised[one.key], final):
            runners_up.append((one, comparisons.evidence(final, fits.look((*final.candidates, one), final)).share))
        else:
            left = final.fit.sse - fits.model.size  # beyond the noise
            runners_up.append((one, min(promised[one.key] / left, 1.0) if left > 0.0 else 0.0))
    models = fits.fit_rivals([((*near.candidates, more), near) for _, more, near in asked], final)
    models = [
        _begun_at(final, model, fits) if taken.kind is Kind.SENSOR else model
        for (taken, _, _), model in zip(asked, models, strict=True)
    ]  # fmt: skip
    by_finding: dict[CandidateKey, list[tuple[Candidate, float]]] = {candidate.key: [] for candidate in final.candidates}
    for (taken, more, _), model in zip(asked, models, strict=True):
        worse = fits.deficit(model, final) + comparisons.price((model, final)) * (model.parameter_count - final.parameter_count)
        by_finding[taken.key].append((more, worse))
    for key, twins in indistinguishable_effects(fits.model, final, proposals.candidates).items():
        same = {twin.at for twin, _ in twins}
        by_finding[key] = [*twins, *(pair for pair in by_finding[key] if pair[0].at not in same)]
    rivals = {key: tuple(sorted(found, key=lambda pair: pair[1])) for key, found in by_finding.items()}
    runners_up.sort(key=lambda pair: -pair[1])
    return SearchResult(comparisons.baseline, final, evidence, rivals, tuple(runners_up), complete)


def _begun_at(final: FittedModel, rival: FittedModel, fits: ModelFits) -> FittedModel:
    """Return the better fit of a rival of a sensor's fault, begun also at the model with that.

    Without the fault, or before it was found, other numbers moved to where a fit of the rival does not find back from.
    """
    begun = FittedModel(tuple(c for c in rival.candidates if c.at in final.named), final.fit)
    other = fits.fit_rivals([(rival.candidates, begun)], final, again=True)[0]
    return other if fits.deficit(other, rival) < 0.0 else rival


def _rivals(candidate: Candidate, without: FittedModel, final: FittedModel, proposals: Proposals) -> list[Candidate]:
    """Return what could take a finding's place.

    In a large model each is a fit of all of it: there only what is declared to look alike is asked, and fitted if it promises enough. Of a
    sensor's fault everything else is asked too, and crowds out nothing that is declared.
    """
    scored = proposals.successors(candidate, without, final)
    if not final.is_large:
        return proposals.best(scored)
    wanted = without.fit.sse - final.fit.sse
    promising = [(promised, rival) for promised, rival in scored if acceptance.UNDERRATED * promised > wanted]
    declared_alike = [(promised, rival) for promised, rival in promising if is_declared_alike(candidate, rival)]
    return list({rival.key: rival for rival in (*proposals.best(declared_alike), *proposals.best(promising))}.values())


def _with_all_parameters(candidate: Candidate, now: FittedModel, fits: ModelFits, proposals: Proposals) -> FittedModel | None:
    """Return a model with all parameters of a finding; None where they are in it already, or do not fit better."""
    fullest = proposals.fullest(candidate)
    if len(fullest.parameters) <= len(candidate.parameters):
        return None
    whole = fits.refined(fits.fit((*now.without(candidate), fullest), now, again=True))
    return whole if fits.deficit(whole, now) <= 0.0 else None
