"""Where the mismatch sits: in which balance, when, and in which regime."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.observed import CylinderRun
from exo_sim.physics.gas import critical_ratio

Array = NDArray[np.float64]

#: Spans are looked for with this window [s], and no more than so many are listed.
SPAN, MOST_SPANS = 0.25, 6
#: Above this many times the noise a span counts as a mismatch.
LOUD = 3.0


@dataclass(frozen=True)
class Trace:
    """The error of one balance along one recording.

    Attributes:
        where, equation: What is unbalanced.
        unit: Of the error.
        recording: Its name.
        time: [s], shape (n,).
        error: Measured less predicted, NaN where not compared, shape (n,).
        noise: What the sensors alone would leave.
        regimes: Name of a regime to where it holds, shape (n,) each.
    """

    where: str
    equation: str
    unit: str
    recording: str
    time: Array
    error: Array
    noise: float
    regimes: dict[str, NDArray[np.bool_]]

    @property
    def excess(self) -> float:
        """Squared error above the noise, in units of the noise, summed: what could be explained."""
        good = self.error[np.isfinite(self.error)]
        return max(float(np.sum((good / self.noise) ** 2 - 1.0)), 0.0) if good.size else 0.0


def loud_spans(trace: Trace) -> tuple[tuple[float, float], ...]:
    """Return the spans in which the error stands out of the noise, the worst first, then in order of time."""
    time, error = trace.time, np.nan_to_num(trace.error)
    size = max(1, int(round(SPAN / max(float(np.median(np.diff(time))), 1e-9))))
    mean = np.convolve((error / trace.noise) ** 2, np.ones(size) / size, mode="same")
    level = max(LOUD**2, 0.3 * float(np.percentile(mean, 98)))
    loud = mean > level
    edges = np.flatnonzero(np.diff(np.concatenate([[0], loud.astype(int), [0]])))
    spans = [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    spans.sort(key=lambda span: -float(mean[span[0] : span[1]].sum()))
    chosen = sorted(spans[:MOST_SPANS])
    return tuple((round(float(time[a]), 3), round(float(time[min(b, len(time) - 1)]), 3)) for a, b in chosen)


def worst_regime(trace: Trace) -> str:
    """Return the regime in which the error is largest for the time spent in it; "throughout" where none stands out."""
    good = np.isfinite(trace.error)
    whole = float(np.mean((trace.error[good] / trace.noise) ** 2)) if good.any() else 0.0
    best, name = 1.3, "throughout"
    for regime, holds in trace.regimes.items():
        here = good & holds
        if here.sum() < max(20, 0.03 * good.sum()):
            continue
        power = float(np.mean((trace.error[here] / trace.noise) ** 2))
        share = power * here.sum() / max(whole * good.sum(), 1e-12)
        if whole > 0.0 and share > 0.4 and power / whole > best:
            best, name = power / whole, regime
    return name


def gas_regimes(run: CylinderRun, side: int, supply: Array, exhaust: Array, k: float) -> dict[str, NDArray[np.bool_]]:
    """Return the regimes of one chamber: what its valve does, choked or not, moving or not."""
    pressure = run.pressure[side]
    assert pressure is not None
    command = run.command if side == 0 else -run.command
    small = 0.01
    filling, venting = command > small, command < -small
    closed = ~filling & ~venting
    limit = critical_ratio(k)
    with np.errstate(invalid="ignore", divide="ignore"):
        choked_in = pressure < limit * supply
        choked_out = exhaust < limit * pressure
        above = pressure > supply
    speed = np.zeros(len(run.time)) if run.speed is None else run.speed
    moving = (
        np.abs(speed) > max(0.005, 0.05 * float(np.nanmax(np.abs(speed))))
        if run.speed is not None
        else np.zeros(len(speed), bool)
    )
    return {
        "valve closed, piston at rest": closed & ~moving,
        "valve closed, piston moving": closed & moving,
        "valve closed": closed,
        "filling, choked": filling & choked_in & ~above,
        "filling, subsonic": filling & ~choked_in & ~above,
        "filling": filling,
        "chamber above supply": above & filling,
        "venting, choked": venting & choked_out,
        "venting, subsonic": venting & ~choked_out,
        "venting": venting,
        "small commands": closed | (np.abs(command) < 0.05),
        "piston moving": moving,
        "piston at rest": ~moving,
        "command near zero crossing": _near_reversal(run.time, run.command),
    }


def _near_reversal(time: Array, command: Array) -> NDArray[np.bool_]:
    crossing = np.flatnonzero(np.diff(np.sign(command)) != 0)
    near = np.zeros(len(time), dtype=bool)
    for index in crossing:
        near[np.searchsorted(time, time[index] - 0.02) : np.searchsorted(time, time[index] + 0.05)] = True
    return near


def motion_regimes(velocity: Array, time: Array) -> dict[str, NDArray[np.bool_]]:
    """Return the regimes of a balance of forces: direction, slow, fast, near a reversal."""
    fast = np.abs(velocity) > np.percentile(np.abs(velocity), 75)
    slow = np.abs(velocity) < np.percentile(np.abs(velocity), 40)
    return {
        "moving out": velocity > 0.0,
        "moving in": velocity < 0.0,
        "moving fast": fast,
        "moving slowly": slow,
        "near a reversal": _near_reversal(time, velocity),
    }
