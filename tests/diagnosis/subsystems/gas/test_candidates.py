"""Candidates for the gas: their bounds follow from the machine."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import cylinder_runs

from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.gas.candidates import WIDEST, candidates
from exo_sim.physics.records import CYLINDER, WORLD


def test_what_is_in_series_with_the_valve_is_not_sought_much_wider_than_it() -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    plant.cylinder["valve_area"], plant.cylinder["area_1"], plant.cylinder["stroke"] = 2e-6, 8e-4, 0.2
    level = np.full(50, 3e5)
    run = cylinder_runs.run_of(level, level, command=np.linspace(-0.2, 0.2, 50), commanded=True)
    asked = candidates(plant, [run], "piston", "slide")
    areas = [q for c in asked if c.effect == "line_restriction" for q in c.parameters if q.parameter == "area"]
    assert areas and all(q.high == pytest.approx(WIDEST * 2e-6) for q in areas)
