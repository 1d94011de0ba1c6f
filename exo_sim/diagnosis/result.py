"""The result of a diagnosis: its verdict and everything found, and the JSON of the contract."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from exo_sim.diagnosis.findings import Finding, Located, NextExperiment, OpenQuestion, Rejected, Series, SignalFit, Unexplained
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
        computed: Columns that were computed and not measured: noise of theirs is what a sensor shows.
        by_chance: Columns that one free run with `improved.toml` misses by more, and runs from several measured states surely by less.
        sizes: Which sizes of the rig are to be checked before what was found is believed, and why, as a clause; "" where none.
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
    computed: tuple[str, ...] = ()
    by_chance: tuple[str, ...] = ()
    sizes: str = ""
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
        return "rms of 0.5 s predictions, motion as recorded" + ("; of a force balance, of what it leaves" if any(balances) else "")

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
            "unexplained": [left.as_dict() for left in self.unexplained],
            "small": [
                {
                    "name": one.name, "where": one.where, "kind": one.kind,
                    "parameters": {name: estimate.as_dict() for name, estimate in one.parameters.items()}, "says": one.says,
                }
                for one in self.small
            ],
            "open": [question.as_dict() for question in self.open_questions],
            "sensors": list(self.sensor_remarks),
            "checks": [dict(check) for check in self.checks],
            "next_experiment": None,
        }  # fmt: skip
        if self.sizes:
            found["sizes"] = self.sizes
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
                    {"do": do, "expected_log10_odds": float(f"{gain:.3g}")} for do, gain in self.next_experiment.ranked
                ]
        return found
