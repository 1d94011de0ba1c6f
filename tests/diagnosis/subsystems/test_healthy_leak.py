"""Leaks that every cylinder has go with the volume that its piston sweeps, and take minutes to empty it."""

from __future__ import annotations

import pytest
from diagnosis import motion_runs

from exo_sim.diagnosis.subsystems.healthy_leak import OUTWARD, external_leaks, swept_volume
from exo_sim.physics import nozzle


def test_the_swept_volume_is_area_times_stroke_and_leaks_are_in_proportion() -> None:
    plant = motion_runs.plant()
    assert swept_volume(plant) == pytest.approx(8e-4 * 0.2)
    one = external_leaks(plant)
    plant.cylinder["stroke"] *= 2.0
    assert external_leaks(plant) == pytest.approx({name: 2.0 * value for name, value in one.items()})
    assert set(one) == {p.name for p in OUTWARD.parameters if p.unit in ("m^2", "kg/(s Pa^2)")}


def test_a_healthy_cylinder_takes_minutes_to_empty() -> None:
    plant = motion_runs.plant()
    flow = nozzle.mass_flow(external_leaks(plant)["area_1"], 6e5, 293.15, 101325.0, 1.4, 287.05)
    mass = 6e5 * swept_volume(plant) / (287.05 * 293.15)
    assert mass / flow > 60.0
