"""Richer forms of an effect replaced by poorer ones: friction of two directions by that of one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from exo_sim.diagnosis.estimation.candidate import Candidate, CandidateKey
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.policy import verdicts
from exo_sim.physics.declaration import declared


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
    candidates: Sequence[Candidate], values: Mapping[FreeParameter, float], asked: Mapping[str, Candidate]
) -> tuple[Candidate, ...]:
    """Return the effects, a richer form replaced by the poorer one where what it tells apart is alike.

    Of a poorer one that the rig has, whose place the richer one took, nothing is left to be found.

    Args:
        candidates: The effects.
        values: Of a model with them.
        asked: Candidates by effect, the poorer forms among them.
    """
    found = []
    for candidate in candidates:
        kept: Candidate | None = candidate
        for poorer, parts in poorer_than(candidate.effect).items():
            known = any(q.effect == poorer for q, _ in candidate.fixed)
            apart = [values[q] for q in candidate.parameters if q.parameter in dict(parts)]
            if (poorer in asked or known) and apart and max(apart) - min(apart) < verdicts.ALIKE * max(apart):
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


def richer_beside(
    candidates: Sequence[Candidate], weighed: Sequence[Candidate], values: Mapping[FreeParameter, float]
) -> dict[CandidateKey, list[tuple[Candidate, float]]]:
    """Return, for each poorer form that a fit ended with, the richer one where that was weighed with what it tells apart far apart.

    Fit and weighing then disagree: the recording does not say which of both it is.

    Args:
        candidates: What the fit ended with.
        weighed: The effects of the most probable subset.
        values: Of that subset.
    """
    found: dict[CandidateKey, list[tuple[Candidate, float]]] = {}
    for poorer in (c for c in candidates if c not in weighed):
        for richer in weighed:
            parts = dict(poorer_than(richer.effect).get(poorer.effect, ()))
            apart = [values[q] for q in richer.parameters if q.parameter in parts]
            if apart and max(apart) - min(apart) > verdicts.ALIKE * max(apart):
                found[poorer.key] = [(richer, 0.0)]
    return found
