"""What a diagnosis says: the JSON of the contract as plain records, and the series that a report draws."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

SCHEMA = "exo-sim/diagnosis/1"
VERDICTS = ("consistent", "calibration", "mismatch", "undetermined")
KINDS = ("missing_physics", "calibration", "sensor", "unknown")

#: Exit status of the command by verdict.
EXIT_STATUS = {"consistent": 0, "calibration": 0, "mismatch": 3, "undetermined": 4}


@dataclass(frozen=True)
class Estimate:
    """A number with its 95 % interval, in SI."""

    value: float
    unit: str
    low: float
    high: float

    def as_dict(self) -> dict[str, Any]:
        return {"value": self.value, "unit": self.unit, "low": self.low, "high": self.high}


@dataclass(frozen=True)
class Finding:
    """One thing that the simulation left out, or has wrong.

    Attributes:
        name: As in the table of effects, or "unknown".
        where: The part, or the column.
        kind: One of `KINDS`.
        says: One plain sentence.
        parameters: Estimates by name; for a calibration the corrected believed number or its factor.
        log10_odds: Against leaving it out.
        held_out_error_drop: By what share the held-out error falls when it is put in.
        ambiguous_with: Names that explain the recording as well.
        probabilities: Of each name of that class, its own included; empty where there is no rival.
        depends_on: For "unknown": the variables that it follows.
        curve: For "unknown": variable, knots, values, band; else None.
    """

    name: str
    where: str
    kind: str
    says: str
    parameters: Mapping[str, Estimate]
    log10_odds: float
    held_out_error_drop: float
    ambiguous_with: tuple[str, ...] = ()
    probabilities: Mapping[str, float] = field(default_factory=dict)
    depends_on: tuple[str, ...] = ()
    curve: Mapping[str, Any] | None = None

    def as_dict(self) -> dict[str, Any]:
        found: dict[str, Any] = {
            "name": self.name,
            "where": self.where,
            "kind": self.kind,
            "says": self.says,
            "parameters": {name: estimate.as_dict() for name, estimate in self.parameters.items()},
            "evidence": {
                "log10_odds": round(self.log10_odds, 2),
                "held_out_error_drop": round(self.held_out_error_drop, 4),
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


@dataclass(frozen=True)
class Located:
    """Where the mismatch sits: part, equation, when, in which regime."""

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
    """A rival that was weighed and put aside, and why."""

    name: str
    where: str
    why: str


@dataclass(frozen=True)
class Unexplained:
    """What remains: where, on what it depends, and its share of the whole error."""

    where: str
    depends_on: tuple[str, ...]
    share: float


@dataclass(frozen=True)
class NextExperiment:
    """What to record next, why, and what it would tell apart."""

    why: str
    do: str
    separates: tuple[str, ...]


@dataclass(frozen=True)
class SignalFit:
    """Held-out error of one signal before and after, beside the sensor's noise; NaN where a simulation was lost."""

    unit: str
    before: float
    after: float
    noise: float

    @property
    def largest(self) -> float:
        """The largest of the three that is known and not zero; 1 where none is."""
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
    """A question that these recordings cannot answer, and why."""

    question: str
    effects: tuple[str, ...]
    why: str


@dataclass
class Diagnosis:
    """The whole answer.

    Attributes:
        recordings: Names of the recordings.
        rig: Name of the rig.
        free_run: Errors of `improved.toml` and of the rig as believed, simulated in one run, by column.
        held_out: Spans of the (first held-out) recording that took no part; whole recordings are named in `held_out_recordings`.
        sensor_remarks: Plain sentences about clocks and sensors: what was used, repaired or set aside.
        improved: Text of `improved.toml`.
    """

    verdict: str
    recordings: tuple[str, ...]
    rig: str
    located: tuple[Located, ...] = ()
    effects: tuple[Finding, ...] = ()
    rejected: tuple[Rejected, ...] = ()
    signals: Mapping[str, SignalFit] = field(default_factory=dict)
    free_run: Mapping[str, SignalFit] = field(default_factory=dict)
    held_out: tuple[tuple[float, float], ...] = ()
    held_out_recordings: tuple[str, ...] = ()
    unexplained: tuple[Unexplained, ...] = ()
    next_experiment: NextExperiment | None = None
    open_questions: tuple[OpenQuestion, ...] = ()
    sensor_remarks: tuple[str, ...] = ()
    series: tuple[Series, ...] = ()
    improved: str = ""

    @property
    def exit_status(self) -> int:
        """Exit status of the command."""
        return EXIT_STATUS[self.verdict]

    @property
    def measure(self) -> str:
        """Say what the errors of `signals` are: pressures are predicted, a balance of forces is closed or not."""
        balances = [name.endswith(".force_balance") for name in self.signals]
        if balances and all(balances):
            return "rms of what the forces' balance leaves over"
        return "rms of 0.5 s predictions" + ("; of forces, of what their balance leaves over" if any(balances) else "")

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
                "held_out": [list(span) for span in self.held_out],
                "held_out_recordings": list(self.held_out_recordings),
                "measure": self.measure,
                "free_run": {name: vars(signal) for name, signal in self.free_run.items()},
            },
            "unexplained": [
                {"where": u.where, "depends_on": list(u.depends_on), "share": round(u.share, 4)} for u in self.unexplained
            ],
            "open": [{"question": q.question, "effects": list(q.effects), "why": q.why} for q in self.open_questions],
            "sensors": list(self.sensor_remarks),
            "next_experiment": None,
        }  # fmt: skip
        if self.next_experiment is not None:
            found["next_experiment"] = {
                "why": self.next_experiment.why,
                "do": self.next_experiment.do,
                "separates": list(self.next_experiment.separates),
            }
        return found
