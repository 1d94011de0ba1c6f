"""Candidates: effects in one of their forms, each a set of free parameters that may be added to a model."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy.priors import PREVALENCE
from exo_sim.physics.declaration import declared

#: Identifies a free parameter: effect, place, name.
ParameterKey = tuple[str, str, str]
#: Identifies a candidate: effect, place, form.
CandidateKey = tuple[str, str, str]


@dataclass(frozen=True)
class Candidate:
    """One effect in one of its forms.

    Attributes:
        effect: Its name.
        where: The part.
        form: Names of the parameters that are free in this form, joined by "+".
        parameters: Those parameters.
        starts: Sets of initial values, in the order of `parameters`.
        kind: What it would be as a finding.
        fixed: Parameters that this form holds at a value.
        proportional: Whether its signature may be scaled up or down until it stands out of the noise.
        prerequisite: Effect without which it makes no sense and which must be in the model too, or "".
        additive: Whether its parameters are parts of one quantity, so that their sum says how large it is.
        prevalence: Share of machines that have it, before any data.
        also: Other places that the same number is of: a card delays all of its columns.
        is_law: Whether it is how a law is written, not physics that is missing: in the model and in the improved rig, but no finding.
        shapes: Where its answer is not in proportion to its size, and no single start is near every machine's: sets of values, in the order
            of `parameters`, among which a fit may begin.
        further: Where it is asked only in the place of a poorer form that stands: names of parameters that this may lack.
    """

    effect: str
    where: str
    form: str
    parameters: tuple[FreeParameter, ...]
    starts: tuple[tuple[float, ...], ...]
    kind: Kind = Kind.MISSING_PHYSICS
    fixed: tuple[tuple[FreeParameter, float], ...] = ()
    proportional: bool = True
    prerequisite: str = ""
    additive: bool = False
    prevalence: float = PREVALENCE
    also: tuple[str, ...] = ()
    is_law: bool = False
    shapes: tuple[tuple[float, ...], ...] = ()
    further: frozenset[str] = frozenset()

    @property
    def key(self) -> CandidateKey:
        """What identifies it."""
        return self.effect, self.where, self.form

    @property
    def at(self) -> tuple[str, str]:
        """Effect and place, whatever the form."""
        return self.effect, self.where

    @property
    def bears(self) -> frozenset[str]:
        """Effects on top of which others may come where it is in a model: itself, and those of which it is the richer form."""
        effect = declared().get(self.effect)
        return frozenset((self.effect, *(poorer for poorer, _ in effect.absorbs))) if effect else frozenset((self.effect,))

    @property
    def displaced(self) -> tuple[tuple[FreeParameter, ParameterKey, float], ...]:
        """Nuisance parameters that may be smaller for it: of which parameter, key, and by how much a unit of that."""
        return tuple((own, key, per_unit) for own in self.parameters for key, per_unit in own.displaces)

    def beside(self, values: Mapping[FreeParameter, float]) -> dict[FreeParameter, float]:
        """Return values of free parameters with what this candidate displaces taken off, inside their bounds."""
        taken = {key: per_unit * values[own] for own, key, per_unit in self.displaced}
        return {q: min(max(value - taken.get(q.key, 0.0), q.low), q.high) for q, value in values.items()}

    @property
    def prior_log_odds(self) -> float:
        """Logarithm of the odds that a machine has it, before any data; nothing for or against a law."""
        return 0.0 if self.is_law else self.prevalence_log_odds

    @property
    def prevalence_log_odds(self) -> float:
        """Logarithm of the odds of `prevalence`, of a law as well: where laws are alternatives of each other."""
        return math.log(self.prevalence / (1.0 - self.prevalence))

    @property
    def label(self) -> str:
        """Effect, place and form in one word."""
        return f"{self.effect}@{self.where}[{self.form}]"


def drop_orphans(candidates: Sequence[Candidate], standing: Collection[str] = ()) -> tuple[Candidate, ...]:
    """Return the candidates whose prerequisite one of them bears or is standing, repeatedly until none is without."""
    borne = {name for candidate in candidates for name in candidate.bears} | set(standing)
    kept = tuple(candidate for candidate in candidates if not candidate.prerequisite or candidate.prerequisite in borne)
    return kept if len(kept) == len(candidates) else drop_orphans(kept, standing)
