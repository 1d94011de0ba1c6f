"""Signals of several clocks on the longest: commands are held, the rest is interpolated, a broken clock is set aside."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.one_clock import on_one_clock

FAST, SLOW = np.linspace(0.0, 1.0, 101, dtype=np.float64), np.linspace(0.0, 1.0, 11, dtype=np.float64)


def test_a_straight_line_is_interpolated_and_a_command_is_held() -> None:
    findings: list[Finding] = []
    series = {"piston.pressure_1": (FAST, 3e5 + FAST), "slide.position": (SLOW, 2.0 * SLOW), "piston.valve_command": (SLOW, SLOW)}
    time, values = on_one_clock(Path("r"), series, findings)
    assert time is FAST
    np.testing.assert_allclose(values["slide.position"], 2.0 * FAST)
    held = values["piston.valve_command"]
    assert held[14] == pytest.approx(0.1) and held[19] == pytest.approx(0.1) and held[20] == pytest.approx(0.2)
    assert {one.column for one in findings} == {"slide.position", "piston.valve_command"}


def test_what_begins_later_is_missing_before() -> None:
    time, values = on_one_clock(Path("r"), {"piston.pressure_1": (FAST, FAST), "slide.position": (SLOW[5:], SLOW[5:])}, [])
    assert np.isnan(values["slide.position"][time < 0.49]).all() and np.isfinite(values["slide.position"][time > 0.51]).all()


def test_a_clock_that_does_not_increase_is_set_aside() -> None:
    findings: list[Finding] = []
    _, values = on_one_clock(Path("r"), {"piston.pressure_1": (FAST, FAST), "slide.position": (SLOW[::-1], SLOW)}, findings)
    assert set(values) == {"piston.pressure_1"} and findings[0].use == "set aside"
