"""Readings that cannot be: each quantity in another unit or out of its range is said, and what can be is not."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.recording import Recording
from exo_sim.recording.health import Facts, plausibility
from exo_sim.recording.noise import floor

TIME = np.arange(2000.0) * 1e-3
WAVE = np.sin(3.0 * TIME)
FACTS = Facts(101325.0, 7e5, {"knee": (0.0, 2.0)})


def kinds(key: str, values: np.ndarray, unit: str) -> list[str]:
    table = Recording("r", TIME, {key: values}, {key: unit})
    return [one.kind for one in plausibility.check(table, key, floor(values, TIME), FACTS)]


@pytest.mark.parametrize(
    ("key", "values", "unit"),
    [("piston.pressure_1", 3e5 + 1e5 * WAVE, "Pa"), ("piston.valve_command", WAVE, "1"), ("knee.position", 1.0 + 0.9 * WAVE, "rad"),
     ("supply.temperature", 293.0 + WAVE, "K"), ("piston.force", 1e4 * WAVE, "N")],
)  # fmt: skip
def test_what_can_be_is_nothing(key: str, values: np.ndarray, unit: str) -> None:
    assert kinds(key, values, unit) == []


@pytest.mark.parametrize(
    ("key", "values", "unit", "kind"),
    [("piston.pressure_1", 3.0 + WAVE, "Pa", "unit"), ("piston.pressure_1", 3e7 + 1e6 * WAVE, "Pa", "unit"),
     ("piston.pressure_1", 2e5 * np.maximum(WAVE, 0.0), "Pa", "gauge"), ("piston.pressure_1", 2e6 + 1e5 * WAVE, "Pa", "range"),
     ("supply.temperature", 20.0 + WAVE, "K", "unit"), ("supply.temperature", 2000.0 + WAVE, "K", "range"),
     ("piston.valve_command", 5.0 * WAVE, "1", "unit"), ("piston.valve_command", 1.1 * WAVE, "1", "range")],
)  # fmt: skip
def test_what_cannot_be_is_said(key: str, values: np.ndarray, unit: str, kind: str) -> None:
    assert kinds(key, values, unit) == [kind]
