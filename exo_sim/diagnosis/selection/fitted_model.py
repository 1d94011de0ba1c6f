"""A set of candidates with its fit, and the result of a search."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.candidate import Candidate, CandidateKey
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.policy import acceptance, off_nominal, priors, verdicts
from exo_sim.diagnosis.policy.budgets import LARGE
from exo_sim.diagnosis.selection.evidence import Evidence
from exo_sim.diagnosis.selection.quantity_parts import parts_of, quantity_of, together
from exo_sim.physics.declaration import declared, identification_of

Array = NDArray[np.float64]


class LeastSquaresModel(Protocol):
    """What a search needs of a subsystem's model; see `subsystem_model.SubsystemModel`."""

    @property
    def blocks(self) -> NDArray[np.int64]: ...

    @property
    def size(self) -> int: ...

    @property
    def discrepancy_bound(self) -> float: ...

    def residual(self, values: dict[FreeParameter, float], fixed: Sequence[tuple[FreeParameter, float]] = ()) -> Array: ...


#: Identifies a set of candidates whatever their order.
SetKey = frozenset[CandidateKey]


def key_of(candidates: Iterable[Candidate]) -> SetKey:
    """Return what identifies a set of candidates."""
    return frozenset(candidate.key for candidate in candidates)


@dataclass(frozen=True)
class FittedModel:
    """A set of candidates, fitted together with the nuisance parameters."""

    candidates: tuple[Candidate, ...]
    fit: Fit

    @classmethod
    def at(cls, values: Mapping[FreeParameter, float], candidates: tuple[Candidate, ...] = ()) -> FittedModel:
        """Return a model at given values, which nothing was fitted to: where a fit may begin."""
        return cls(candidates, Fit((), dict(values), np.zeros(0), np.zeros((0, 0))))

    @property
    def named(self) -> set[tuple[str, str]]:
        """Effects and places that are in it."""
        return {candidate.at for candidate in self.candidates}

    @property
    def bears(self) -> set[str]:
        """Effects that are in it, wherever, in this form or a richer one."""
        return {name for candidate in self.candidates for name in candidate.bears}

    @property
    def is_large(self) -> bool:
        """Whether each fit beside it is one of so many parameters that only what promises something is worth it."""
        return len(self.candidates) >= LARGE

    def meets_prerequisite(self, candidate: Candidate) -> bool:
        """Return whether the effect that a candidate comes on top of is in it."""
        return not candidate.prerequisite or candidate.prerequisite in self.bears

    def without(self, candidate: Candidate) -> tuple[Candidate, ...]:
        """Return all of its candidates but one."""
        return tuple(c for c in self.candidates if c is not candidate)

    @property
    def effect_parameters(self) -> set[FreeParameter]:
        """The free parameters of its candidates."""
        return {parameter for candidate in self.candidates for parameter in candidate.parameters}

    @property
    def fixed(self) -> list[tuple[FreeParameter, float]]:
        """Parameters that the forms of its candidates hold at a value."""
        return [pair for candidate in self.candidates for pair in candidate.fixed]

    @property
    def parameter_count(self) -> int:
        """Number of its candidates' free parameters."""
        return sum(len(candidate.parameters) for candidate in self.candidates)


@dataclass(frozen=True)
class Unnamed:
    """What is missing beside the names, a function of one variable of no particular form.

    Attributes:
        variable: What it depends on.
        probability: That it is there.
        share: Its root mean square, in units of all that acts of its kind, what the rig knows of it included.
    """

    variable: str
    probability: float
    share: float


@dataclass(frozen=True)
class SearchResult:
    """What a search ended with.

    Attributes:
        baseline: The nuisance parameters alone.
        final: With everything that was accepted.
        evidence: For each accepted candidate against leaving it out.
        rivals: By accepted candidate: candidates for its place, and by how much their log-likelihood is lower, parameters paid for.
        runners_up: Candidates that were not accepted in the end, with the share of what is left that they explain.
        complete: By accepted candidate that is additive and of which a simpler form was taken: the model with all of its parameters.
        probabilities: Of effects being present, by effect and place, where subsets of them were weighed.
        errors: Standard deviations of parameters that also count what every model of a machine gets wrong.
        reach: How far laws that fit as well reach towards lower values and towards higher ones, in standard errors of a 95 % interval.
        least_left: Sum of squares that the same effects leave where nothing but that decides their numbers; infinite where it is `final`'s.
        unnamed: What is missing beside the names, the largest first.
        stands_for: By effect and place of nominal numbers that are further off than any data sheet allows, effects that explain as much.
        undecided: Candidates that were weighed as probable and gave way to nuisance parameters that are plainly further off without them.
        straining: Candidates that were left out because they stand only beside numbers that are further off with them.
        interrupted: Whether it ended before everything was explained, because it was asked to.
        weighed_together: Whether all subsets of effects were weighed beside a model discrepancy: names then stand although something is
            left, and each explains only what the others leave to it.
    """

    baseline: FittedModel
    final: FittedModel
    evidence: Mapping[CandidateKey, Evidence] = field(default_factory=dict)
    rivals: Mapping[CandidateKey, Sequence[tuple[Candidate, float]]] = field(default_factory=dict)
    runners_up: Sequence[tuple[Candidate, float]] = ()
    complete: Mapping[CandidateKey, FittedModel] = field(default_factory=dict)
    probabilities: Mapping[tuple[str, str], float] = field(default_factory=dict)
    errors: Mapping[FreeParameter, float] = field(default_factory=dict)
    reach: Mapping[FreeParameter, tuple[float, float]] = field(default_factory=dict)
    least_left: float = math.inf
    unnamed: tuple[Unnamed, ...] = ()
    stands_for: Mapping[tuple[str, str], tuple[str, ...]] = field(default_factory=dict)
    undecided: tuple[Candidate, ...] = ()
    straining: tuple[Candidate, ...] = ()
    interrupted: bool = False
    weighed_together: bool = False


def is_more_than_healthy(candidate: Candidate, model: FittedModel, errors: Mapping[FreeParameter, float] | None = None) -> bool:
    """Return whether a candidate may stand in a model: how a law is written may, whatever it says; arguments as `exceeds_healthy_limit`."""
    return candidate.is_law or exceeds_healthy_limit(candidate, model, errors)


def exceeds_healthy_limit(
    candidate: Candidate, model: FittedModel, errors: Mapping[FreeParameter, float] | None = None, times: float | None = None
) -> bool:
    """Return whether any parameter of a candidate is further from neutral than in a healthy machine (practical significance).

    Args:
        candidate: One of the model's, or of those whose parts are refitted in every model.
        model: Its values.
        errors: Standard errors; with them a parameter counts only if it is surely further out.
        times: By how many of its own; None for `SURELY_MORE`.
    """
    values, errors = model.fit.values, errors or {}
    times = float(acceptance.SURELY_MORE) if times is None else times
    limited = [q for q in candidate.parameters if q.healthy_limit > 0.0]
    if candidate.additive and candidate.parameters:  # with what a healthy machine has of it, where the candidate does not stand for that
        own = [q for q in candidate.parameters if q in values]
        parts = parts_of(quantity_of(candidate.parameters[0]), (*values, *own))
        return together(parts, values) > max((q.healthy_limit for q in limited), default=0.0)
    return not limited or any(abs(values[q] - q.neutral) - times * errors.get(q, 0.0) > q.healthy_limit for q in limited)


def remains(candidate: Candidate, without: FittedModel) -> bool:
    """Return whether a model without a candidate still holds more of its effect than a healthy machine has, as numbers that are refitted.

    Args:
        candidate: Whose parameters are parts of one quantity, or not.
        without: A model that it was left out of.
    """
    return candidate.additive and candidate.at not in without.named and exceeds_healthy_limit(candidate, without)


def as_in_a_healthy_machine(candidate: Candidate, model: FittedModel) -> dict[FreeParameter, float]:
    """Return the refitted parts of a candidate's quantity as they are where together they are no more than a healthy machine has of it.

    Args:
        candidate: Whose parameters are parts of one quantity.
        model: Where they are refitted, and together more.
    """
    values = model.fit.values
    parts = parts_of(quantity_of(candidate.parameters[0]), values)
    limit = max((q.healthy_limit for q in candidate.parameters), default=0.0)
    share = limit / max(together(parts, values), limit)
    return {q: q.neutral + share * (values[q] - q.neutral) for q in parts}


def reach_of_bound(parameter: FreeParameter, value: float) -> float:
    """Return how near to a bound of a parameter a value counts as there."""
    return verdicts.AT_BOUND * (abs(value) if parameter.logarithmic or parameter.low > 0.0 else parameter.scale)


def is_at_bound(candidate: Candidate, model: FittedModel) -> bool:
    """Return whether what decides of a candidate how large it is ended at a bound where it still acts: no number was found.

    A speed of its law ends where the recording's slow motion does: a dip that is narrower than that has a size all the same. So has a hose
    that is too wide to throttle anything, by the gas that it holds.
    """
    if candidate.is_law or candidate.effect not in declared():
        return False
    asked = identification_of(candidate.effect)
    speeds, open_above = asked.within_speeds, asked.saturates if _holds_more_than_dead_volume(candidate, model) else ()
    needed = {p.name for p in declared()[candidate.effect].parameters if p.required and p.name not in speeds}
    if len(candidate.parameters) == 1:  # one of several ways to say how large it is
        needed.add(candidate.parameters[0].parameter)
    for q in (q for q in candidate.parameters if q.parameter in needed):
        value = model.fit.values[q]
        reach = reach_of_bound(q, value)
        ends_above = q.high != q.neutral and q.high - value < reach and q.parameter not in open_above
        if ends_above or (q.low != q.neutral and value - q.low < reach):
            return True
    return False


def _holds_more_than_dead_volume(candidate: Candidate, model: FittedModel) -> bool:
    """Return whether what owners count among the dead volumes is more than their data sheets leave open of these."""
    values, most = model.fit.values, off_nominal.HELD_WITHIN * priors.DEAD_VOLUME
    return any(values[own] * per_unit > most for own, _, per_unit in candidate.displaced)
