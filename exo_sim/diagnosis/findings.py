"""What a diagnosis says of one thing, as plain records: findings, places, errors, questions, and the series that a report draws."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.policy.verdicts import MOST_CONFIDENT


class Kind(StrEnum):
    """What a finding is about."""

    MISSING_PHYSICS = "missing_physics"
    UNKNOWN = "unknown"
    SENSOR = "sensor"
    CALIBRATION = "calibration"


class Subsystem(StrEnum):
    """A part of the plant that is judged alone, cut out at the measured signals."""

    GAS = "gas"
    MOTION = "motion"
    SUPPLY = "supply"


@dataclass(frozen=True)
class Estimate:
    """A number with its 95 % interval, in SI."""

    value: float
    unit: str
    low: float
    high: float

    def as_dict(self) -> dict[str, Any]:
        return {"value": self.value, "unit": self.unit, "low": self.low, "high": self.high}


def held_out_key(name: str, where: str) -> str:
    """Return `name@where`, by which errors on held-out time are kept."""
    return f"{name}@{where}"


@dataclass(frozen=True)
class _Named:
    """What is said by name of one place."""

    name: str
    where: str

    @property
    def at(self) -> tuple[str, str]:
        """Name and place."""
        return self.name, self.where


@dataclass(frozen=True)
class Finding(_Named):
    """One thing that the simulation leaves out or has wrong.

    Attributes:
        name: As in the table of effects, or "unknown".
        where: The part, or the column.
        kind: What it is about.
        says: One plain sentence.
        parameters: Estimates by name; for a calibration the corrected nominal number or its factor.
        log10_odds: Odds against leaving it out.
        probability: That it is present, where it was weighed beside all others; None where only its odds are known.
        held_out_error_drop: By what share the held-out error falls when it is put in.
        ambiguous_with: Names that explain the recording as well.
        probabilities: Of each name of that class, its own included; empty where there is no rival.
        depends_on: For "unknown": the variables that it depends on.
        curve: For "unknown": variable, knots, values, band; else None.
        cost: What its absence costs the machine's own predictions on held-out time, as a share of how much those signals vary.
        also: Other columns that have the same error: they share a card.
    """

    kind: Kind
    says: str
    parameters: Mapping[str, Estimate]
    log10_odds: float
    held_out_error_drop: float
    ambiguous_with: tuple[str, ...] = ()
    probabilities: Mapping[str, float] = field(default_factory=dict)
    depends_on: tuple[str, ...] = ()
    curve: Mapping[str, Any] | None = None
    probability: float | None = None
    cost: float = 0.0
    also: tuple[str, ...] = ()

    @property
    def numbers(self) -> dict[str, float]:
        """Its parameters without their intervals."""
        return {name: one.value for name, one in self.parameters.items()}

    @property
    def key(self) -> str:
        """Name and place in one word, by which errors on held-out time are kept."""
        return held_out_key(self.name, self.where)

    def at_each_place(self) -> tuple[Finding, ...]:
        """Return the finding at each of its places."""
        return tuple(replace(self, where=place, also=()) for place in (self.where, *self.also))

    @property
    def confidence(self) -> float:
        """Probability that it is present: as weighed, else from the odds, in either case no more than experience bears."""
        weighed = self.probability
        if weighed is None:
            weighed = 1.0 / (1.0 + 10.0 ** -min(max(self.log10_odds, -12.0), 12.0))
        return min(weighed, float(MOST_CONFIDENT))

    def as_dict(self) -> dict[str, Any]:
        found: dict[str, Any] = {
            "name": self.name,
            "where": self.where,
            "kind": self.kind,
            "says": self.says,
            "parameters": {name: estimate.as_dict() for name, estimate in self.parameters.items()},
            "probability": round(self.confidence, 3),
            "evidence": {
                "log10_odds": round(self.log10_odds, 2),
                "probability": round(self.confidence, 3),
                "held_out_error_drop": round(self.held_out_error_drop, 4),
                "cost": float(f"{self.cost:.3g}"),
            },
            "ambiguous_with": list(self.ambiguous_with),
        }
        if self.probabilities:
            found["probabilities"] = {name: round(p, 4) for name, p in self.probabilities.items()}
        if self.depends_on:
            found["depends_on"] = list(self.depends_on)
        if self.curve is not None:
            found["curve"] = dict(self.curve)
        return found


def in_order(findings: Iterable[Finding]) -> list[Finding]:
    """Return findings as they are listed: physics, named or not, by what its absence costs; then sensors, then nominal numbers."""
    last = {Kind.SENSOR: 1, Kind.CALIBRATION: 2}
    return sorted(findings, key=lambda f: (last.get(f.kind, 0), -f.cost, -f.log10_odds))


@dataclass(frozen=True)
class Located:
    """Where the mismatch is: part, equation, when, in which regime."""

    where: str
    equation: str
    share: float
    when: tuple[tuple[float, float], ...]
    regime: str
    error: float
    noise: float
    unit: str
    recording: str = ""


@dataclass(frozen=True)
class Rejected(_Named):
    """A candidate that was considered and rejected, and why."""

    why: str


@dataclass(frozen=True)
class Unexplained:
    """What no name explains: where, on what it depends, its share of the whole error, its rms and the noise in a unit.

    `by_curve` is the share of its variance that a curve over that signal predicts; 0 where there is none.
    """

    where: str
    depends_on: tuple[str, ...]
    share: float
    error: float = 0.0
    noise: float = 0.0
    unit: str = ""
    by_curve: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        found: dict[str, Any] = {
            "where": self.where, "depends_on": list(self.depends_on), "share": round(self.share, 4), "error": self.error,
            "noise": self.noise, "unit": self.unit,
        }  # fmt: skip
        return found | ({"by_curve": round(self.by_curve, 3)} if self.by_curve > 0.0 else {})


@dataclass(frozen=True)
class NextExperiment:
    """What to record next, why, and which effects it separates.

    `ranked` holds experiments with the log10 of the odds that each is expected to give, by simulation, the best first.
    """

    why: str
    do: str
    separates: tuple[str, ...]
    ranked: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class SignalFit:
    """Held-out error of one signal before and after, beside the sensor's noise; NaN where a simulation diverged."""

    unit: str
    before: float
    after: float
    noise: float

    @property
    def largest(self) -> float:
        """The largest of the three that is positive; 1 where none is."""
        return max((value for value in (self.before, self.after, self.noise) if value > 0.0), default=1.0)


@dataclass(frozen=True)
class Series:
    """One signal of one recording for pictures: measured, predicted before and after, shape (n,) each."""

    recording: str
    signal: str
    unit: str
    time: NDArray[np.float64]
    recorded: NDArray[np.float64]
    before: NDArray[np.float64]
    after: NDArray[np.float64]
    noise: float


@dataclass(frozen=True)
class OpenQuestion:
    """A question that these recordings cannot answer, why, and what to do for an answer.

    `effects` are names of effects; `called` says in words what they are where they are many.
    """

    question: str
    effects: tuple[str, ...]
    why: str
    do: str = "record the missing signal as well"
    called: str = ""

    def as_dict(self) -> dict[str, Any]:
        found: dict[str, Any] = {"question": self.question, "effects": list(self.effects), "why": self.why}
        return found | ({"called": self.called} if self.called else {})
