"""A sensor that shows one value while the machine moves is stuck; one that runs into its end is clipped; rest is neither."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.recording import Recording
from exo_sim.recording.health import stuck_or_clipped
from exo_sim.recording.noise import floors

TIME = np.arange(6000.0) * 1e-3
RNG = np.random.default_rng(5)
MOVING = 0.05 * np.sin(3.0 * TIME)


def kinds(pressure: np.ndarray) -> dict[str, tuple[tuple[int, int], ...]]:
    columns = {"piston.pressure_1": pressure, "slide.position": MOVING + RNG.normal(0.0, 1e-5, TIME.size)}
    table = Recording("r", TIME, columns, {"piston.pressure_1": "Pa", "slide.position": "m"})
    return {one.kind: one.rows for one in stuck_or_clipped.check(table, "piston.pressure_1", floors(table))}


def noisy(values: np.ndarray) -> np.ndarray:
    return values + RNG.normal(0.0, 200.0, TIME.size)


CLEAN = noisy(3e5 + 8e4 * np.sin(3.0 * TIME))


def test_a_lively_sensor_is_nothing() -> None:
    assert kinds(CLEAN) == {}


def test_a_stuck_one_is_found_in_its_rows() -> None:
    values = CLEAN.copy()
    values[2000:4000] = values[2000]
    ((first, last),) = kinds(values)["stuck"]
    assert first == pytest.approx(2000, abs=2) and last == pytest.approx(4000, abs=2)


def test_one_that_runs_into_its_end_is_clipped() -> None:
    assert set(kinds(np.minimum(CLEAN, 3.5e5))) == {"clipped"}


def test_a_regulated_supply_that_toggles_between_steps_of_a_coarse_converter_is_nothing() -> None:
    step = 1222.0
    for offset in (0.0, 0.35, 0.45):
        values = step * np.round(600.0 + offset + RNG.normal(0.0, 0.25, TIME.size))
        assert len(np.unique(values)) <= 4
        assert kinds(values) == {}
