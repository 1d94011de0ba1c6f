"""The result of a diagnosis as plain records: the JSON of the contract, and the series that a report draws."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.policy.verdicts import MOST_CONFIDENT
from exo_sim.recording.table import Recording

SCHEMA = "exo-sim/diagnosis/1"


class Verdict(StrEnum):
    """The answer in one word; `exit_status` is that of the command."""

    CONSISTENT = "consistent"
    CALIBRATION = "calibration"
    MISMATCH = "mismatch"
    UNDETERMINED = "undetermined"

    @property
    def exit_status(self) -> int:
        """0 where recording and rig agree, at most after a calibration; 3 for a mismatch; 4 where nobody can tell."""
        return {"mismatch": 3, "undetermined": 4}.get(self.value, 0)


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
class Finding:
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

    name: str
    where: str
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
    def at(self) -> tuple[str, str]:
        """Name and place."""
        return self.name, self.where

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
class Rejected:
    """A candidate that was considered and rejected, and why."""

    name: str
    where: str
    why: str

    @property
    def at(self) -> tuple[str, str]:
        """Name and place."""
        return self.name, self.where


@dataclass(frozen=True)
class Unexplained:
    """What remains unexplained: where, on what it depends, its share of the whole error, its rms and the noise in a unit."""

    where: str
    depends_on: tuple[str, ...]
    share: float
    error: float = 0.0
    noise: float = 0.0
    unit: str = ""


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
    """A question that these recordings cannot answer, why, and what to do for an answer."""

    question: str
    effects: tuple[str, ...]
    why: str
    do: str = "record the missing signal as well"


@dataclass(frozen=True)
class Diagnosis:
    """The whole answer.

    Attributes:
        recordings: Names of the recordings.
        rig: Name of the rig.
        free_run: Errors of `improved.toml` and of the rig as handed in, simulated in one run, by column.
        held_out: By recording, spans of its time that are for the test.
        small: What the data show beyond doubt, but too little of it to matter.
        sensor_remarks: Plain sentences about clocks and sensors: what was used, repaired or left out.
        checks: What was asked of the recordings, and put right, before any physics: plain records of `what`, `columns` and `says`.
        improved: Text of `improved.toml`.
        improves: Whether it holds anything that the rig does not.
        tables: The recordings in the conventions of the format, for pictures.
        stopped: Whether a budget ended it before everything had been sought.
    """

    verdict: Verdict
    recordings: tuple[str, ...]
    rig: str
    located: tuple[Located, ...] = ()
    effects: tuple[Finding, ...] = ()
    rejected: tuple[Rejected, ...] = ()
    signals: Mapping[str, SignalFit] = field(default_factory=dict)
    free_run: Mapping[str, SignalFit] = field(default_factory=dict)
    held_out: Mapping[str, tuple[tuple[float, float], ...]] = field(default_factory=dict)
    unexplained: tuple[Unexplained, ...] = ()
    small: tuple[Finding, ...] = ()
    next_experiment: NextExperiment | None = None
    open_questions: tuple[OpenQuestion, ...] = ()
    sensor_remarks: tuple[str, ...] = ()
    checks: tuple[Mapping[str, Any], ...] = ()
    series: tuple[Series, ...] = ()
    improved: str = ""
    improves: bool = True
    tables: tuple[Recording, ...] = ()
    stopped: bool = False

    @property
    def exit_status(self) -> int:
        """Exit status of the command."""
        return self.verdict.exit_status

    @property
    def measure(self) -> str:
        """What the errors of `signals` are, in words."""
        balances = [name.endswith(".force_balance") for name in self.signals]
        if balances and all(balances):
            return "rms of what the balance of forces leaves"
        return "rms error of 0.5 s predictions" + ("; for a force balance, rms of what it leaves" if any(balances) else "")

    def as_dict(self) -> dict[str, Any]:
        """Return the JSON of the contract."""
        found: dict[str, Any] = {
            "schema": SCHEMA,
            "verdict": self.verdict,
            "recordings": list(self.recordings),
            "located": [
                {
                    "where": place.where, "equation": place.equation, "share": round(place.share, 4),
                    "when": [list(span) for span in place.when], "regime": place.regime, "error": place.error,
                    "noise": place.noise, "unit": place.unit, "recording": place.recording,
                }
                for place in self.located
            ],
            "effects": [finding.as_dict() for finding in self.effects],
            "rejected": [{"name": r.name, "where": r.where, "why": r.why} for r in self.rejected],
            "fit": {
                "signal": {name: vars(signal) for name, signal in self.signals.items()},
                "held_out": [list(span) for span in next(iter(self.held_out.values()), ())],
                "held_out_by_recording": {name: [list(span) for span in spans] for name, spans in self.held_out.items()},
                "measure": self.measure,
                "free_run": {name: vars(signal) for name, signal in self.free_run.items()},
            },
            "unexplained": [
                {
                    "where": u.where, "depends_on": list(u.depends_on), "share": round(u.share, 4), "error": u.error, "noise": u.noise,
                    "unit": u.unit,
                }
                for u in self.unexplained
            ],
            "small": [
                {
                    "name": one.name, "where": one.where, "kind": one.kind,
                    "parameters": {name: estimate.as_dict() for name, estimate in one.parameters.items()}, "says": one.says,
                }
                for one in self.small
            ],
            "open": [{"question": q.question, "effects": list(q.effects), "why": q.why} for q in self.open_questions],
            "sensors": list(self.sensor_remarks),
            "checks": [dict(check) for check in self.checks],
            "next_experiment": None,
        }  # fmt: skip
        if self.stopped:
            found["stopped"] = True
        if self.next_experiment is not None:
            found["next_experiment"] = {
                "why": self.next_experiment.why,
                "do": self.next_experiment.do,
                "separates": list(self.next_experiment.separates),
            }
            if self.next_experiment.ranked:
                found["next_experiment"]["ranked"] = [
                    {"do": do, "expected_log10_odds": float(f"{min(gain, 12.0):.3g}")} for do, gain in self.next_experiment.ranked
                ]
        return found
