"""What is in a recording: its signals, the gait, the cylinders and joints, and everything that looks wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from exo_sim.recording import health, noise
from exo_sim.recording.columns import signal_of
from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.gait_events import feet
from exo_sim.recording.reader import Reading
from exo_sim.recording.table import Recording
from exo_sim.signals import VALVE_COMMANDS

#: Of a valve that is open: from the supply into one chamber, and out of the other. `choked` counts those that are.
_PATHS = 2.0


@dataclass(frozen=True)
class Summary:
    """A recording in numbers, SI throughout, as plain JSON types.

    Attributes:
        head: Name, duration, samples, rate and metadata.
        signals: One entry a column: least, mean, greatest, rms, noise, missing samples.
        gait: One entry a foot; empty where none was recorded.
        cylinders: By name: pressures, force, command, choking, gas used.
        joints: By name: range, speed, torque.
        findings: What looks wrong, the gravest first.
    """

    head: dict[str, Any]
    signals: list[dict[str, Any]]
    gait: list[dict[str, Any]]
    cylinders: dict[str, dict[str, Any]]
    joints: dict[str, dict[str, Any]]
    findings: tuple[Finding, ...]


def summarise(reading: Reading, facts: health.Facts | None = None) -> Summary:
    """Look a recording through.

    Args:
        reading: As `recording.read` gives it.
        facts: What is known of the machine, for the questions that need it.
    """
    recording = reading.recording
    gait = _gait(recording)
    strides = max((foot["strides"] for foot in gait), default=0)
    parts: dict[str, dict[str, set[str]]] = {"cylinder": {}, "joint": {}}
    for key in recording.columns:
        kind = signal_of(key).part
        if kind in parts:
            part, signal = key.rsplit(".", 1)
            parts[kind].setdefault(part, set()).add(signal)
    findings = [*reading.findings, *health.check(recording, facts), *_odd_physics(recording)]
    gravity = {"fault": 0, "warning": 1, "info": 2}
    return Summary(
        head=_head(recording),
        signals=_signals(recording),
        gait=gait,
        cylinders={part: _cylinder(recording, part, strides) for part in parts["cylinder"]},
        joints={part: _joint(recording, part) for part in parts["joint"]},
        findings=tuple(sorted(findings, key=lambda finding: gravity[finding.severity])),
    )


def as_dict(summary: Summary) -> dict[str, Any]:
    """Return the summary for `--json`, schema `exo-sim/inspect/1`."""
    return {
        "schema": "exo-sim/inspect/1",
        **summary.head,
        "signals": summary.signals,
        "gait": summary.gait,
        "cylinders": summary.cylinders,
        "joints": summary.joints,
        "findings": [finding.as_dict() for finding in summary.findings],
    }


def _head(recording: Recording) -> dict[str, Any]:
    steps = np.diff(recording.time)
    return {
        "name": recording.name,
        "start_s": float(recording.time[0]),
        "duration_s": recording.duration,
        "samples": len(recording.time),
        "rate_hz": 1.0 / float(np.median(steps)),
        "metadata": dict(recording.metadata),
    }


def _signals(recording: Recording) -> list[dict[str, Any]]:
    floors = noise.floors(recording)
    entries = []
    for key, values in recording.columns.items():
        floor = floors[key]
        entries.append(
            {
                "name": key,
                "unit": recording.units[key],
                "least": float(np.nanmin(values)),
                "mean": float(np.nanmean(values)),
                "greatest": float(np.nanmax(values)),
                "rms": float(np.sqrt(np.nanmean(np.square(values)))),
                "noise": floor.std,
                "noise_is_a_bound": floor.signal_share > 0.5,
                "step": floor.step,
                "missing": int(np.isnan(values).sum()),
            }
        )
    return entries


def _gait(recording: Recording) -> list[dict[str, Any]]:
    entries = []
    for foot in feet(recording):
        times = foot.stride_times
        entries.append(
            {
                "foot": foot.foot,
                "strides": len(times),
                "stride_s": float(times.mean()) if len(times) else None,
                "stride_spread_s": float(times.std()) if len(times) else None,
                "stance_share": foot.stance_share,
                "peak_force_n": foot.peak_force,
                "contacts_s": list(foot.contacts),
                "leaves_s": list(foot.leaves),
            }
        )
    return entries


def _cylinder(recording: Recording, part: str, strides: int) -> dict[str, Any]:
    entry: dict[str, Any] = {}
    for chamber in (1, 2):
        pressure = recording.get(f"{part}.pressure_{chamber}")
        if pressure is not None:
            entry[f"pressure_{chamber}_pa"] = [float(np.nanmin(pressure)), float(np.nanmax(pressure))]
    force, demanded = recording.get(f"{part}.force"), recording.get(f"{part}.force_demanded")
    if force is not None:
        entry["force_peak_n"] = float(np.nanmax(np.abs(force)))
        if demanded is not None:
            entry["force_error_rms_n"] = float(np.sqrt(np.nanmean(np.square(force - demanded))))
    commands = [recording[key] for name in VALVE_COMMANDS if (key := f"{part}.{name}") in recording]
    choked = recording.get(f"{part}.choked")
    if commands:
        entry["valve_closed_share"] = float(np.nanmean(np.max(np.abs(commands), axis=0) < 1e-3))
    if choked is not None:
        entry["choked_share"] = float(np.nanmean(choked)) / _PATHS
    used = recording.get(f"{part}.gas_used")
    if used is not None:
        entry["gas_used_kg"] = float(np.nanmax(used) - np.nanmin(used))
        if strides:
            entry["gas_used_kg_per_stride"] = entry["gas_used_kg"] / recording.duration * _stride_time(recording)
    return entry


def _stride_time(recording: Recording) -> float:
    return float(np.mean(np.concatenate([foot.stride_times for foot in feet(recording)])))


def _joint(recording: Recording, part: str) -> dict[str, Any]:
    entry: dict[str, Any] = {}
    position, velocity = recording.get(f"{part}.position"), recording.get(f"{part}.velocity")
    if position is not None:
        entry["unit"] = recording.units[f"{part}.position"]
        entry["range"] = [float(np.nanmin(position)), float(np.nanmax(position))]
    if velocity is not None:
        entry["speed_peak"] = float(np.nanmax(np.abs(velocity)))
    for signal in ("torque", "external_force", "wearer_moment"):
        values = recording.get(f"{part}.{signal}")
        if values is not None:
            entry[f"{signal}_peak"] = float(np.nanmax(np.abs(values)))
            entry[f"{signal}_rms"] = float(np.sqrt(np.nanmean(np.square(values))))
    torque, demanded = recording.get(f"{part}.torque"), recording.get(f"{part}.torque_demanded")
    if torque is not None and demanded is not None:
        entry["torque_error_rms"] = float(np.sqrt(np.nanmean(np.square(torque - demanded))))
    return entry


def _odd_physics(recording: Recording) -> list[Finding]:
    """Look for what no machine and no walk does."""
    found = []
    for key, values in recording.columns.items():
        if key.endswith(".ground_force_z"):
            low, high = float(np.nanquantile(values, 0.001)), float(np.nanmax(values))
            if low < -0.05 * high - 5.0:
                says = f'"{key}" falls to {low:.4g} N: the ground does not pull; is the sign right, up positive?'
                found.append(Finding(key, "ground pulls", says, severity="warning"))
            if high < 5.0:
                found.append(
                    Finding(key, "no contact", f'"{key}" never exceeds {high:.3g} N: no contact', severity="info")
                )
    supply = recording.get("supply.pressure")
    if supply is not None:
        most = float(np.nanquantile(supply, 0.99))
        for key, values in recording.columns.items():
            if key.endswith((".pressure_1", ".pressure_2")) and np.nanmax(values) > 1.1 * most:
                share = float(np.nanmean(values > supply))
                says = (
                    f'"{key}" exceeds the supply by up to {np.nanmax(values) - most:.3g} Pa, in {100 * share:.2g} % of '
                    "the rows: the load compresses the gas, or a sensor's scale is off"
                )
                found.append(Finding(key, "above supply", says, severity="info"))
    return found
