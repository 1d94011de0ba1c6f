"""The clock: gaps, lost samples, uneven and slow clocks, each by its size."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.recording import Recording
from exo_sim.recording.health import clock

EVEN = np.arange(2000.0) * 1e-3


def kinds(time: np.ndarray) -> dict[str, str]:
    return {found.kind: found.says for found in clock.check(Recording("r", time, {}, {}))}


@pytest.mark.parametrize("time", [EVEN, EVEN[:2], EVEN + 100.0])
def test_an_even_clock_is_nothing(time: np.ndarray) -> None:
    assert kinds(time) == {}


def test_a_gap_is_said_with_its_length_and_its_row() -> None:
    found = clock.check(Recording("r", EVEN + 0.5 * (EVEN > 0.9995), {}, {}))
    assert [one.kind for one in found] == ["gap"] and "0.501 s" in found[0].says and found[0].rows == ((999, 1001),)


def test_lost_samples_are_counted() -> None:
    says = kinds(np.delete(EVEN, [500, 501, 900]))
    assert "about 3 of 2000" in says["dropouts"]


def test_jitter_and_a_slow_clock() -> None:
    rng = np.random.default_rng(0)
    assert "jitter" in kinds(EVEN + rng.uniform(-2e-4, 2e-4, EVEN.size))
    assert "only 10 samples a second" in kinds(np.arange(50.0) * 0.1)["slow clock"]
