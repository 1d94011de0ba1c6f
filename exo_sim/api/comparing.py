"""`exo.compare`: what a rig predicts of a recording, beside what was recorded."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exo_sim.api.arguments import Columns, RecordingLike, RigLike, check_target, reading_of, rig_of
from exo_sim.api.notebook import html_table
from exo_sim.api.recording import Recording
from exo_sim.api.rig import Rig
from exo_sim.conventions import Check, settle
from exo_sim.diagnosis.data.computed_columns import shown_noise, was_computed
from exo_sim.errors import Diverged
from exo_sim.machine.rig_model import load
from exo_sim.plain_text import table
from exo_sim.recording import noise
from exo_sim.simulation import replay as replays

if TYPE_CHECKING:
    from exo_sim.api.figure import Picture
    from exo_sim.simulation.replay import Replay

#: Samples of a recording that the viewer is given; errors count all of them.
_MOST_SHOWN = 400_000
_HEADER = ("signal", "unit", "0.5 s windows", "free run", "noise")


@dataclass(frozen=True, repr=False)
class Comparison:
    """What a rig predicts of a recording.

    Attributes:
        recording: As it was compared: conventions settled; with the samples that no sensor can have seen.
        rig: The machine.
        windowed: Predictions over windows of 0.5 s, each from the measured state.
        free_run: Predictions in one run from the first measured state.
        signals: For each predicted signal its `unit`, `windowed_rms`, `free_run_rms` and the sensor's `noise`, in SI.
        remarks: Plain sentences about what was odd or assumed.
        summary: What `exo-sim compare --json` prints, without file names.
    """

    recording: Recording
    rig: Rig
    windowed: Recording
    free_run: Recording
    signals: dict[str, dict[str, Any]]
    remarks: tuple[str, ...]
    summary: dict[str, Any]

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write a recording for the rerun viewer (`.rrd`): the machine as it was recorded, recorded and simulated signals overlaid.

        Raises:
            OutputError: the ending is another, or it cannot be written.
        """
        from exo_sim.recording import write_rrd
        from exo_sim.simulation.machine_scene import recorded_scene

        target = check_target(path)
        overlays = {"simulated": self.windowed.thinned(_MOST_SHOWN), "free_run": self.free_run.thinned(_MOST_SHOWN)}
        shown = self.recording.thinned(_MOST_SHOWN)
        write_rrd(target, shown, recorded_scene(shown, self.rig), overlays=overlays)
        return target

    def plot(self, signals: Sequence[str] | None = None) -> Picture:
        """Draw recorded and simulated signals over each other; those that were predicted when `signals` is None."""
        from exo_sim.api.plots import panels

        lines = [("recorded", self.recording), ("0.5 s windows", self.windowed), ("free run", self.free_run)]
        return panels(lines, list(self.signals) if signals is None else signals)

    def _rows(self) -> list[list[str]]:
        return [
            [key, one["unit"], *(_number(one[name]) for name in ("windowed_rms", "free_run_rms", "noise"))]
            for key, one in self.signals.items()
        ]

    def __str__(self) -> str:
        rows = self._rows()
        lines = [table(rows, _HEADER), "", f"{self.summary['measure']}."]
        if any("-" in row for row in rows):
            lines.append("A dash: the simulation left all bounds before the recording's end.")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<exo.Comparison of {self.recording.name} with {self.rig.name}: {len(self.signals)} signals>"

    def _repr_html_(self) -> str:
        return html_table(self._rows(), _HEADER, self.summary["measure"])


def compare(
    recording: RecordingLike, rig: RigLike, *, motion: str = "auto", columns: Columns = None,
    progress: Callable[[float], None] | None = None,
) -> Comparison:  # fmt: skip
    """Predict every measured pressure and position of a recording, over windows of 0.5 s and in one run from the first state.

    Args:
        recording: A path or `exo.Recording`.
        rig: A path or `exo.Rig`: the nominal machine, as its owner describes it.
        motion: "predicted": positions are predicted too; "recorded": they are led as recorded; "auto" leads them where forces that
            nobody measured moved them.
        columns: Foreign names: a column map (TOML) or a dictionary.
        progress: Called with the share done, 0 to 1.

    Raises:
        RecordingError, RigError, ModelError: unusable input; one line each.
        Diverged: the simulation left all bounds within a window.
    """
    from exo_sim.errors import RecordingError, nearest

    if motion not in ("auto", "predicted", "recorded"):
        raise RecordingError(f'motion "{motion}"{nearest(motion, ("auto", "predicted", "recorded"))}')
    reading = reading_of(recording, columns)
    machine = rig_of(rig)
    model = load(machine)
    replays.check_belongs(reading.recording, machine, model)
    settled = settle(reading.recording, machine, model, reading.findings)
    recorded, odd = replays.usable(settled.recording, machine, model)
    replay = replays.replay(recorded, machine, model, motion=motion, progress=progress)
    signals = _errors(recorded, replay)
    if lost := [key for key, one in signals.items() if not math.isfinite(one["windowed_rms"])]:
        name = reading.recording.name if not isinstance(recording, str | os.PathLike) else os.fspath(recording)
        raise Diverged(
            f'"{name}": within {replays.WINDOW:g} s of measured states the simulation left all bounds, first of {lost[0]}; look '
            f"at the numbers of {machine.path} and its MJCF with exo-sim inspect --rig, or try a shorter timestep"
        )
    noticed = [finding.says for finding in [*reading.findings, *odd] if finding.severity != "info"]
    remarks = tuple(dict.fromkeys((*(check.says for check in settled.checks), *noticed, *replay.remarks)))
    return Comparison(
        Recording.of(settled.recording), machine, Recording.of(replay.windowed), Recording.of(replay.free_run), signals, remarks,
        _summary(replay, signals, remarks, settled.checks),
    )  # fmt: skip


def _errors(recording: Any, replay: Replay) -> dict[str, dict[str, Any]]:
    """Return, for each predicted signal, the errors of both predictions and the sensor's noise."""
    return {
        key: {
            "unit": recording.units[key],
            "windowed_rms": replays.rms(recording[key], replay.windowed[key]),
            "free_run_rms": replays.rms(recording[key], replay.free_run[key]),
            "noise": shown_noise(noise.floor(recording[key], recording.time).std, recording[key], was_computed(recording)),
        }
        for key in replay.windowed.columns
    }


def _summary(
    replay: Replay, signals: dict[str, dict[str, Any]], remarks: tuple[str, ...], checks: tuple[Check, ...]
) -> dict[str, Any]:
    return {
        "schema": "exo-sim/compare/1",
        "measure": replay.measure,
        "signal": signals,
        "motion": "recorded" if replay.imposed else "predicted",
        "remarks": list(remarks),
        "checks": [check.as_dict() for check in checks],
    }


def _number(value: float) -> str:
    return f"{value:.4g}" if value == value else "-"
