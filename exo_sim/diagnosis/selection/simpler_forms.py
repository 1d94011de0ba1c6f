"""Richer forms of an effect replaced by poorer ones: friction of two directions by that of one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from exo_sim.diagnosis.estimation.candidate import Candidate, CandidateKey
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.policy import verdicts
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.physics.declaration import declared, identification_of


def poorer_than(effect: str) -> dict[str, tuple[tuple[str, str], ...]]:
    """Return the effects of which one is the richer form, and which of its parameters contain which of theirs; none of a sensor's fault."""
    return dict(declared()[effect].absorbs) if effect in declared() else {}


def no_richer_than_needed(
    candidates: Sequence[Candidate], rivals: Mapping[CandidateKey, Sequence[tuple[Candidate, float]]]
) -> tuple[Candidate, ...]:
    """Return the effects, a richer form replaced by the poorer one where that explains the recording as well.

    Args:
        candidates: The effects.
        rivals: For each, what may stand in its place, and by how much its log-likelihood is lower.
    """
    found = []
    for candidate in candidates:
        absorbed = poorer_than(candidate.effect)
        poorer = [c for c, worse in rivals.get(candidate.key, []) if c.effect in absorbed and worse <= verdicts.AS_GOOD]
        found.append(poorer[0] if poorer else candidate)
    return tuple(found)


def poorer_where_alike(
    candidates: Sequence[Candidate], values: Mapping[FreeParameter, float], asked: Mapping[str, Candidate], constant: float = 0.0
) -> tuple[Candidate, ...]:
    """Return the effects, a richer form replaced by the poorer one where what it tells apart is alike.

    Of a poorer one that the rig has, whose place the richer one took, nothing is left to be found.

    Args:
        candidates: The effects.
        values: Of a model with them.
        asked: Candidates by effect, the poorer forms among them.
        constant: The greatest constant force that sensors within their data sheets make beside them [N or N m].
    """
    found = []
    for candidate in candidates:
        kept: Candidate | None = candidate
        for poorer in poorer_than(candidate.effect):
            known = any(q.effect == poorer for q, _ in candidate.fixed)
            if (poorer in asked or known) and _is_alike(candidate, poorer, values, constant):
                kept = asked.get(poorer)
        found += [kept] if kept is not None else []
    return tuple(found)


def sizes_of_poorer(
    candidates: Sequence[Candidate], poorer: Sequence[Candidate], values: Mapping[FreeParameter, float]
) -> dict[FreeParameter, float]:
    """Return where a fit with poorer forms begins: each of their numbers is the mean of those that it takes the place of.

    From a typical value instead a dip of friction that is then below the level of the contact answers to nothing.

    Args:
        candidates, poorer: The effects before and after.
        values: Of a model with the former.
    """
    begun: dict[FreeParameter, float] = {}
    for candidate in candidates:
        for name, shares in poorer_than(candidate.effect).items():
            for q in (q for c in poorer if c.effect == name for q in c.parameters):
                own = [values[p] for p in candidate.parameters if (p.parameter, q.parameter) in shares]
                if own and q not in values:
                    begun[q] = sum(own) / len(own)
    return begun


def in_poorer_forms(
    final: FittedModel, kept: tuple[Candidate, ...], asked: Mapping[str, Candidate], constant: float,
    fit: Callable[[tuple[Candidate, ...], FittedModel], FittedModel], deficit: Callable[[FittedModel, FittedModel], float], size: int,
) -> FittedModel:  # fmt: skip
    """Return a model with poorer forms where what the richer ones tell apart is alike and they are as good; else the model itself.

    Gains below the noise count for nothing. Where sensors within their data sheets make the difference what these are off by does not
    count against the poorer forms, and the gain does.

    Args:
        final: A fitted model.
        kept: Its effects, or those of them that stay.
        asked, constant: As of `poorer_where_alike`.
        fit: Fits candidates from a similar model.
        deficit: By how much the log-likelihood of one model is lower than another's.
        size: Rows.
    """
    poorer = poorer_where_alike(kept, final.fit.values, asked)
    by_sensors = poorer == kept
    if by_sensors:
        poorer = poorer_where_alike(kept, final.fit.values, asked, constant)
    if poorer == kept:
        return final
    simpler = fit(poorer, FittedModel.at({**final.fit.values, **sizes_of_poorer(kept, poorer, final.fit.values)}))
    lost = deficit(simpler, final)
    if by_sensors:
        lost -= 0.5 * max(simpler.fit.penalty - final.fit.penalty, 0.0)
    as_good = lost <= verdicts.AS_GOOD or (not by_sensors and simpler.fit.sse <= size)
    return simpler if as_good else final


@dataclass(frozen=True)
class RicherForm:
    """A richer form that stands beside the poorer one that a search ended with.

    Attributes:
        candidate: It.
        worse: By how much its log-evidence is lower.
        numbers: Of the poorer one's parameters: the least and the greatest of its own numbers that each takes the place of.
    """

    candidate: Candidate
    worse: float
    numbers: Mapping[FreeParameter, tuple[float, float]]


def richer_beside(
    final: FittedModel, weighed: Sequence[Candidate], fit: Callable[[tuple[Candidate, ...]], FittedModel],
    log_evidence: Callable[[FittedModel], float],
) -> dict[CandidateKey, RicherForm]:  # fmt: skip
    """Return, for each poorer form that a search ended with, the richer one that was weighed.

    Subsets are weighed along lines, over a grid of shapes. The richer form is fitted as it acts: where what it tells apart is then alike
    it is the poorer one in other words, and nothing stands beside that.

    Args:
        final: What the search ended with.
        weighed: The effects of the most probable subset.
        fit: Fits candidates.
        log_evidence: Of a fitted model, parameters paid for.
    """
    found: dict[CandidateKey, RicherForm] = {}
    for poorer in (c for c in final.candidates if c not in weighed):
        for richer in (c for c in weighed if poorer.effect in poorer_than(c.effect)):
            fitted = fit(tuple(richer if c is poorer else c for c in final.candidates))
            if not _is_alike(richer, poorer.effect, fitted.fit.values):
                worse = log_evidence(fit(final.candidates)) - log_evidence(fitted)
                found[poorer.key] = RicherForm(richer, worse, _numbers_of(richer, poorer, fitted.fit.values))
    return found


def rivals_of_either(
    richer: Mapping[CandidateKey, RicherForm], rivals: Mapping[CandidateKey, Sequence[tuple[Candidate, float]]]
) -> dict[CandidateKey, list[tuple[Candidate, float]]]:
    """Return rivals, those of a poorer form with the richer one beside it among them, and with what may stand in that one's place.

    Args:
        richer: By the key of the poorer form.
        rivals: What may stand in the place of each effect that was weighed, and by how much its log-likelihood is lower.
    """
    found = {key: list(those) for key, those in rivals.items()}
    for key, form in richer.items():
        others = [(c, worse) for c, worse in rivals.get(form.candidate.key, ()) if c.key != key]
        found[key] = [*found.get(key, []), (form.candidate, form.worse), *others]
    return found


def _numbers_of(
    richer: Candidate, poorer: Candidate, values: Mapping[FreeParameter, float]
) -> dict[FreeParameter, tuple[float, float]]:
    """Return the least and the greatest number of a richer form in the place of each of a poorer one's."""
    shares, found = poorer_than(richer.effect)[poorer.effect], {}
    for q in poorer.parameters:
        own = [values[p] for p in richer.parameters if (p.parameter, q.parameter) in shares]
        if own:
            found[q] = min(own), max(own)
    return found


def _is_alike(richer: Candidate, poorer: str, values: Mapping[FreeParameter, float], constant: float = 0.0) -> bool:
    """Return whether the numbers of a richer form that are one number of a poorer one hardly differ, or by what a constant force makes."""
    parts = dict(poorer_than(richer.effect)[poorer])
    apart = [values[q] for q in richer.parameters if q.parameter in parts]
    if not apart:
        return False
    between = max(apart) - min(apart)
    beside_constant = identification_of(richer.effect).twins.beside_constant == poorer
    return between < verdicts.ALIKE * max(apart) or (beside_constant and 0.5 * between <= constant)
