"""What sensors make of the truth, and back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim import rig as rigs
from exo_sim.recording import Recording
from exo_sim.rig import EffectSetting, Rig
from exo_sim.simulation.sensors import observe, seen_through

TIME = np.linspace(0.0, 2.0, 2001)
COLUMN = "piston.pressure_1"
TRUTH = Recording("r", TIME, {COLUMN: 5e5 + 1e5 * np.sin(5.0 * TIME), "slide.position": 0.1 * TIME}, {COLUMN: "Pa", "slide.position": "m"})


@pytest.fixture(scope="module")
def bench(repository: Path) -> Rig:
    return rigs.read(repository / "assets" / "bench.toml")


def with_faults(rig: Rig, *settings: EffectSetting) -> Rig:
    return replace(rig, effects=settings)


@given(seconds=st.floats(-0.02, 0.02), factor=st.floats(0.8, 1.25), value=st.floats(-1e5, 1e5))
def test_what_was_shown_gives_back_what_was_there(repository: Path, seconds: float, factor: float, value: float) -> None:
    rig = with_faults(
        rigs.read(repository / "assets" / "bench.toml"),
        EffectSetting("sensor_bias", COLUMN, {"value": value}),
        EffectSetting("sensor_delay", COLUMN, {"seconds": seconds}),
        EffectSetting("sensor_scale", COLUMN, {"factor": factor}),
    )
    back, mended = seen_through(observe(TRUTH, rig), rig)
    assert mended == (COLUMN,)
    inside = slice(40, -40)
    np.testing.assert_allclose(back[COLUMN][inside], TRUTH[COLUMN][inside], atol=30.0)  # two interpolations between samples
    np.testing.assert_array_equal(back["slide.position"], TRUTH["slide.position"])


def test_a_hole_stays_a_hole(bench: Rig) -> None:
    values = TRUTH[COLUMN].copy()
    values[500:510] = np.nan
    rig = with_faults(bench, EffectSetting("sensor_delay", COLUMN, {"seconds": 0.004}))
    back, _ = seen_through(replace(TRUTH, columns={**TRUTH.columns, COLUMN: values}), rig)
    assert np.flatnonzero(~np.isfinite(back[COLUMN])).tolist() == list(range(500, 510))


def test_a_late_sensor_that_shows_nothing_still_shows_nothing(bench: Rig) -> None:
    rig = with_faults(bench, EffectSetting("sensor_delay", COLUMN, {"seconds": 0.004}))
    back, _ = seen_through(replace(TRUTH, columns={**TRUTH.columns, COLUMN: np.full_like(TIME, np.nan)}), rig)
    assert np.isnan(back[COLUMN]).all()


def test_a_column_that_was_not_recorded_asks_for_nothing(bench: Rig) -> None:
    rig = with_faults(bench, EffectSetting("sensor_bias", "piston.pressure_2", {"value": 1e3}))
    back, mended = seen_through(TRUTH, rig)
    assert mended == () and back.columns.keys() == TRUTH.columns.keys()
