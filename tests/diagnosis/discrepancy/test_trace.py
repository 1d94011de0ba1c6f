"""The error along a recording: what exceeds the noise, when, and in which regime."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.diagnosis.discrepancy.trace import Trace, near_reversal

TIME = np.arange(10_000, dtype=float) * 1e-3
NOISE = np.random.default_rng(5).standard_normal(TIME.size)


def trace(error: np.ndarray, noise: float = 1.0, **regimes: np.ndarray) -> Trace:
    return Trace("piston/chamber_1", "energy balance", "Pa", "monday", TIME, error, noise, regimes)


def test_noise_alone_leaves_nothing_to_explain() -> None:
    assert trace(NOISE).excess < 0.05 * TIME.size
    assert trace(0.5 * NOISE).excess == 0.0
    assert trace(np.full(TIME.size, np.nan)).excess == 0.0


def test_a_burst_is_listed_with_its_time() -> None:
    burst = NOISE + 20.0 * ((TIME > 4.0) & (TIME < 5.0))
    ((begin, end),) = trace(burst).loud_spans()
    assert begin == pytest.approx(4.0, abs=0.15) and end == pytest.approx(5.0, abs=0.15)
    assert trace(burst).excess == pytest.approx(400.0 * 1000, rel=0.05)


def test_the_regime_with_the_largest_error_is_named() -> None:
    closed = np.sin(TIME) > 0.0
    assert trace(NOISE + 5.0 * closed, closed=closed, open=~closed).worst_regime() == "closed"
    assert trace(5.0 * NOISE, closed=closed, open=~closed).worst_regime() == "throughout"


def test_what_was_not_compared_does_not_count() -> None:
    error = NOISE + 5.0
    error[::2] = np.nan
    assert trace(error).excess == pytest.approx(25.0 * TIME.size / 2, rel=0.1)


def test_around_a_reversal() -> None:
    near = near_reversal(TIME, np.sin(2.0 * np.pi * 0.5 * (TIME - 0.5)))
    assert near[int(1.5 / 1e-3)] and near[int(1.49 / 1e-3)] and near[int(1.54 / 1e-3)]
    assert not near[int(1.45 / 1e-3)] and not near[int(1.6 / 1e-3)]
