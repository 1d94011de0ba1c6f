"""The error of one balance along one recording: how far it exceeds the noise, when, and in which regime."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.policy import regimes
from exo_sim.diagnosis.policy.budgets import MOST_SPANS
from exo_sim.diagnosis.policy.recordings import LOUD

Array = NDArray[np.float64]

#: Spans are found by averaging over this window [s].
SPAN = 0.25


@dataclass(frozen=True)
class Trace:
    """The error of one balance along one recording.

    Attributes:
        where, equation: What does not balance.
        unit: Of the error.
        recording: Its name.
        time: [s], shape (n,).
        error: Measured less predicted, NaN where not compared, shape (n,).
        noise: Standard deviation that the sensors alone would leave.
        regimes: Name of a regime to where it holds, shape (n,) each.
    """

    where: str
    equation: str
    unit: str
    recording: str
    time: Array
    error: Array
    noise: float
    regimes: Mapping[str, NDArray[np.bool_]]

    @property
    def excess(self) -> float:
        """Sum of squared errors above the noise, in units of the noise: what could be explained."""
        good = self.error[np.isfinite(self.error)]
        return max(float(np.sum((good / self.noise) ** 2 - 1.0)), 0.0) if good.size else 0.0

    def loud_spans(self) -> tuple[tuple[float, float], ...]:
        """Return the worst spans in which the error exceeds the noise, in order of time [s]."""
        time, error = self.time, np.nan_to_num(self.error)
        size = max(1, int(round(SPAN / max(float(np.median(np.diff(time))), 1e-9))))
        mean = np.convolve((error / self.noise) ** 2, np.ones(size) / size, mode="same")
        level = max(LOUD**2, regimes.LOUDEST * float(np.percentile(mean, 98)))
        loud = mean > level
        edges = np.flatnonzero(np.diff(np.concatenate([[0], loud.astype(int), [0]])))
        spans = [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
        spans.sort(key=lambda span: -float(mean[span[0] : span[1]].sum()))
        chosen = sorted(spans[:MOST_SPANS])
        return tuple((round(float(time[a]), 3), round(float(time[min(b, len(time) - 1)]), 3)) for a, b in chosen)

    def worst_regime(self) -> str:
        """Return the regime whose error is largest for the time spent in it; "throughout" where none stands out."""
        good = np.isfinite(self.error)
        whole = float(np.mean((self.error[good] / self.noise) ** 2)) if good.any() else 0.0
        best, name = float(regimes.STANDS_OUT), "throughout"
        for regime, holds in self.regimes.items():
            here = good & holds
            if here.sum() < max(regimes.FEWEST_IN_IT, regimes.LEAST_TIME * good.sum()):
                continue
            power = float(np.mean((self.error[here] / self.noise) ** 2))
            share = power * here.sum() / max(whole * good.sum(), 1e-12)
            if whole > 0.0 and share > regimes.MOST_OF_IT and power / whole > best:
                best, name = power / whole, regime
        return name


def near_reversal(time: Array, signal: Array) -> NDArray[np.bool_]:
    """Return which samples lie just before and after a change of sign, shape (n,)."""
    crossing = np.flatnonzero(np.diff(np.sign(signal)) != 0)
    near = np.zeros(len(time), dtype=bool)
    for index in crossing:
        begin, end = time[index] - regimes.BEFORE_REVERSAL, time[index] + regimes.AFTER_REVERSAL
        near[np.searchsorted(time, begin) : np.searchsorted(time, end)] = True
    return near
