"""A set of candidates with its fit, and what a search says of it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.fitting import Fit
from exo_sim.diagnosis.quantity import Candidate, Quantity
from exo_sim.diagnosis.weighing import Weighing

Array = NDArray[np.float64]


class Problem(Protocol):
    """What the search needs of a cut."""

    blocks: NDArray[np.int64]

    @property
    def size(self) -> int: ...

    @property
    def sick(self) -> float: ...

    def residual(self, values: dict[Quantity, float], fixed: Sequence[tuple[Quantity, float]] = ()) -> Array: ...


#: Names a set of candidates whatever their order.
SetKey = frozenset[tuple[str, str, str]]


def key_of(chosen: Iterable[Candidate]) -> SetKey:
    """Return what names a set of candidates."""
    return frozenset(candidate.key for candidate in chosen)


@dataclass
class Trial:
    """One set of candidates, fitted."""

    chosen: tuple[Candidate, ...]
    fit: Fit

    @property
    def keys(self) -> set[tuple[str, str]]:
        """Effects and places that are in it."""
        return {(candidate.effect, candidate.where) for candidate in self.chosen}

    def bears(self, candidate: Candidate) -> bool:
        """Say whether what a candidate comes on top of is in it."""
        return not candidate.beside or any(c.effect == candidate.beside for c in self.chosen)

    def others(self, candidate: Candidate) -> tuple[Candidate, ...]:
        """Return all of it but one candidate."""
        return tuple(c for c in self.chosen if c is not candidate)

    @property
    def asked(self) -> set[Quantity]:
        """The numbers of its candidates."""
        return {quantity for candidate in self.chosen for quantity in candidate.quantities}

    @property
    def fixed(self) -> list[tuple[Quantity, float]]:
        """What the forms of its candidates pin to a value."""
        return [pair for candidate in self.chosen for pair in candidate.fixed]

    @property
    def numbers(self) -> int:
        """How many numbers its candidates have."""
        return sum(len(candidate.quantities) for candidate in self.chosen)


@dataclass
class Found:
    """What a search ended with.

    Attributes:
        start: Believed numbers refitted, nothing added.
        end: With everything that was accepted.
        weighings: By candidate key: what dropping it would cost.
        rivals: By candidate key: what would take its place and how much worse that fits (log-likelihood, numbers paid for).
        runners_up: Candidates that were considered at the end and not accepted, with the share of what is left that they explain.
        halted: Whether it ended before everything was explained, because it was asked to.
        whole: By candidate key, of one whose numbers are parts of one thing and of which some were left out: fitted with all of them.
    """

    start: Trial
    end: Trial
    weighings: dict[tuple[str, str, str], Weighing] = field(default_factory=dict)
    rivals: dict[tuple[str, str, str], list[tuple[Candidate, float]]] = field(default_factory=dict)
    runners_up: list[tuple[Candidate, float]] = field(default_factory=list)
    whole: dict[tuple[str, str, str], Trial] = field(default_factory=dict)
    halted: bool = False


def sizeable(candidate: Candidate, trial: Trial, spread: Mapping[Quantity, float] | None = None) -> bool:
    """Say whether any of a candidate's numbers is further from neutral than a healthy machine's would be.

    Args:
        candidate: One of the trial's.
        trial: Its numbers.
        spread: Standard deviations of the numbers; with them a number counts only if it is further out by two of its own.
    """
    values, spread = trial.fit.values, spread or {}
    asked = [q for q in candidate.quantities if q.least > 0.0]
    if candidate.adds_up:  # with what a healthy machine has of it, where the candidate does not stand for that
        parts = {q.field: q for q in (*values, *candidate.quantities) if (q.effect, q.where) == (candidate.effect, candidate.where)}
        return sum(abs(values[q] - q.neutral) for q in parts.values()) > max((q.least for q in asked), default=0.0)
    return not asked or any(abs(values[q] - q.neutral) - 2.0 * spread.get(q, 0.0) > q.least for q in asked)
