"""What takes the place of an effect in other subsets of a linear family, what counts as the same, and what came next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from exo_sim.diagnosis.estimation.candidate import Candidate, CandidateKey
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy import verdicts
from exo_sim.diagnosis.policy.budgets import RUNNERS_UP
from exo_sim.diagnosis.selection.linear_evidence import Posterior
from exo_sim.diagnosis.selection.subset_weighing import At, SubsetWeighing, Weighed


def rivals(weighing: SubsetWeighing, best: Weighed, finalists: Sequence[Weighed]) -> dict[CandidateKey, list[tuple[Candidate, float]]]:
    """Return, for each effect, those that stand in its place in other subsets, and by how much these are less probable.

    Also what stands in the place of several at once: drag beside dry friction slows a swing as damping alone does.

    Args:
        weighing: Of the subsets.
        best: The most probable subset.
        finalists: Those that were weighed to the end, the best first.
    """
    family = weighing.family
    mine = {c.at: c for c in weighing.candidates(best)}
    groups = {linear.candidate.at: "" for linear in family.linearisations if linear.candidate is not None} | _groups(weighing)
    found: dict[CandidateKey, dict[At, tuple[Candidate, float]]] = {c.key: {} for c in mine.values()}
    for other in finalists[1:]:
        theirs = {c.at: c for c in weighing.candidates(other)}
        gone, new = set(mine) - set(theirs), set(theirs) - set(mine)
        fewer = len(gone) > 1 and len(new) == 1 and all(_is_effect(mine[at]) for at in gone)  # one does what several do together
        for lost in gone if fewer or len(gone) == 1 else ():
            taking = [theirs[at] for at in new if _is_effect(theirs[at]) and (len(new) == 1 or groups[at] == groups[lost])]
            if len(taking) == 1:
                found[mine[lost].key].setdefault(taking[0].at, (taking[0], best.score - other.score))
    return {key: sorted(by.values(), key=lambda pair: pair[1]) for key, by in found.items()}


def equivalents(
    weighing: SubsetWeighing, best: Weighed, taking: Mapping[CandidateKey, Sequence[tuple[Candidate, float]]]
) -> dict[At, set[At]]:
    """Return, for each effect of the best subset, itself, the others of its group, and its rivals: what takes its place in others.

    Args:
        weighing, best: As of `rivals`.
        taking: The rivals.
    """
    groups, found = _groups(weighing), {}
    for candidate in weighing.candidates(best):
        group = groups.get(candidate.at)
        alike = {at for at, other in groups.items() if group is not None and other == group}
        instead = {rival.at for rival, worse in taking[candidate.key] if worse <= verdicts.AS_GOOD}
        found[candidate.at] = {candidate.at} | alike | instead
    return found


def equivalents_of(candidate: Candidate, found: Mapping[At, set[At]]) -> set[At]:
    """Return the equivalents of an effect of the final model, which may be a poorer form of one of the best subset."""
    return next((own for own in found.values() if candidate.at in own), {candidate.at})


def runners_up(weighing: SubsetWeighing, best: Weighed, posterior: Posterior) -> list[tuple[Candidate, float]]:
    """Return effects that are not in the best subset, with the share of what is left that each would explain.

    Args:
        weighing, best: As of `rivals`.
        posterior: Of the best subset.
    """
    inside = {c.at for c in weighing.candidates(best)}
    groups = {term.group for term in weighing.terms(best)}
    left = float(posterior.left @ posterior.left)
    found: dict[At, tuple[Candidate, float]] = {}
    for j, term in enumerate(weighing.family.linearisations[best.point].terms):
        if term.candidate.at in inside or term.group in groups or not _is_effect(term.candidate):
            continue
        more = weighing.posterior(best, (j,))
        share = max(1.0 - float(more.left @ more.left) / max(left, 1e-300), 0.0)
        if share > found.get(term.candidate.at, (term.candidate, -1.0))[1]:
            found[term.candidate.at] = term.candidate, share
    return sorted(found.values(), key=lambda pair: -pair[1])[:RUNNERS_UP]


def _groups(weighing: SubsetWeighing) -> dict[At, str]:
    """Return the group of each effect that has terms."""
    return {term.candidate.at: term.group for linear in weighing.family.linearisations for term in linear.terms}


def _is_effect(candidate: Candidate) -> bool:
    """Return whether a candidate is an effect of the list: neither a law of one nor what has no name."""
    return not candidate.is_law and candidate.kind is not Kind.UNKNOWN
