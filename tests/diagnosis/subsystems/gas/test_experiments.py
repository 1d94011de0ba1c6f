"""Recordings that could be made of a cylinder: within its stroke and its supply, with the sensors that it has."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis.cylinder_runs import run_of

from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.gas.experiments import LENGTH, STEP, menu

ROOM, SUPPLY = 1e5, 7e5
PLANT = PlantParameters(
    np.array([(ROOM, SUPPLY)], dtype=[("atmosphere", float), ("supply_pressure", float)]), np.zeros(1, np.void)
)
BOTH = (np.full(100, 3e5), np.full(100, 2e5))
STROKE = np.linspace(0.05, 0.25, 100)


def test_each_stays_within_stroke_command_and_supply() -> None:
    runs = menu(run_of(*BOTH, length=STROKE, commanded=True), PLANT)
    assert len(runs) == 7
    for run in runs.values():
        assert run.length is not None and run.time[-1] == pytest.approx(LENGTH - STEP)
        assert STROKE.min() - 1e-12 <= run.length.min() and run.length.max() <= STROKE.max() + 1e-12
        assert np.abs(run.command).max() <= 1.0
        assert all(p is not None and ROOM < p[0] < SUPPLY for p in run.pressure)


def test_a_piston_moves_or_a_valve_opens_never_both() -> None:
    for run in menu(run_of(*BOTH, length=STROKE, commanded=True), PLANT).values():
        assert run.length is not None and not (np.ptp(run.length) > 0.0 and np.ptp(run.command) > 0.0)


def test_a_valve_without_a_command_is_left_closed() -> None:
    runs = menu(run_of(*BOTH, length=STROKE), PLANT)
    assert len(runs) == 4 and not any(run.command.any() for run in runs.values())


def test_a_pressure_that_has_no_sensor_has_none_there_either() -> None:
    for run in menu(run_of(BOTH[0], None, length=STROKE), PLANT).values():
        assert run.pressure[0] is not None and run.pressure[1] is None
