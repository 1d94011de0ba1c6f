"""Single samples of one column: missing ones, lone spikes, and how finely it is read out."""

from __future__ import annotations

import numpy as np

from exo_sim.recording.data_quality_finding import Finding, Severity
from exo_sim.recording.health.spans import listed, runs, where
from exo_sim.recording.noise import Noise
from exo_sim.recording.table import Recording
from exo_sim.signals import VALVE_COMMANDS

#: A lone sample that leaves its neighbours by this share of the range, and much more than they differ, is a spike.
SPIKE = 0.1


def check(recording: Recording, key: str, noise: Noise) -> list[Finding]:
    """Look at the samples of one column."""
    return [*_missing(recording, key), *_spikes(recording, key, noise), *_steps(recording, key, noise)]


def _missing(recording: Recording, key: str) -> list[Finding]:
    missing = np.isnan(recording[key])
    if not missing.any():
        return []
    spans = runs(missing)
    rows, times = listed(spans, recording.time)
    share = missing.mean()
    says = f'"{key}" has no number in {int(missing.sum())} of {len(missing)} rows, {where(spans, recording.time)}'
    severity: Severity = "fault" if share > 0.5 else "warning"
    return [Finding(key, "missing samples", says, rows, times, severity=severity, use="set aside")]


def _spikes(recording: Recording, key: str, noise: Noise) -> list[Finding]:
    if recording.units.get(key) not in ("Pa", "K") and not key.endswith(".position"):
        return []
    values = recording[key]
    if len(values) < 20:
        return []
    spread = float(np.nanmax(values) - np.nanmin(values))
    sides = 0.5 * (values[1:-3] + values[3:-1])
    away = np.abs(values[2:-2] - sides)
    around = (
        np.abs(values[1:-3] - values[3:-1]) + np.abs(values[:-4] - values[1:-3]) + np.abs(values[4:] - values[3:-1])
    )
    lone = (away > SPIKE * spread) & (away > 10.0 * around + 10.0 * noise.std)
    if not lone.any():
        return []
    spans = runs(np.concatenate(([False, False], lone, [False, False])))
    rows, times = listed(spans, recording.time)
    many = "1 lone spike" if len(spans) == 1 else f"{len(spans)} lone spikes"
    says = f'"{key}" has {many} that no machine could follow, {where(spans, recording.time)}'
    return [Finding(key, "spikes", says, rows, times, severity="warning", use="set aside")]


def _steps(recording: Recording, key: str, noise: Noise) -> list[Finding]:
    if noise.step == 0.0 or noise.step < 2.0 * noise.white:
        return []
    values = recording[key]
    spread = float(np.nanmax(values) - np.nanmin(values))
    levels = round(spread / noise.step)
    if levels > 5000 or key.rsplit(".", 1)[-1] in (*VALVE_COMMANDS, "choked", "stance_l", "stance_r"):
        return []
    unit = recording.units.get(key, "")
    says = f'"{key}" moves in steps of {noise.step:.4g} {unit}, coarser than its noise: {levels} levels over its range'
    return [Finding(key, "quantised", says, severity="warning" if levels < 30 else "info")]
