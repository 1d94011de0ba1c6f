"""A vessel of two chambers whose gas is not as warm as the room where its recording begins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from diagnosis.cylinder_runs import run_of

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.gas.inputs import inputs
from exo_sim.diagnosis.subsystems.gas.prediction import run_gas
from exo_sim.physics.plant_records import CYLINDER, WORLD

PERIOD, N, NOISE = 2e-3, 3000, 100.0


def vessel() -> PlantParameters:
    world, cylinder = np.zeros(1, WORLD), np.zeros(1, CYLINDER)
    world["k"], world["r"], world["atmosphere"], world["ambient"] = 1.4, 287.05, 101325.0, 293.15
    world["supply_pressure"], world["supply_temperature"], world["exhaust_pressure"] = 7e5, 293.15, 101325.0
    cylinder["area_1"], cylinder["area_2"], cylinder["stroke"], cylinder["valve_area"] = 2e-3, 1.8e-3, 0.2, 2e-6
    cylinder["dead_volume_1"] = cylinder["dead_volume_2"] = 2e-5
    cylinder["wall_heat_transfer"]["conductance"] = 0.4
    return PlantParameters(world, cylinder)


def recorded(warmth: tuple[float, float], travel: float = 0.0) -> CylinderRun:
    """Two chambers with the valve shut, then a short fill and vent; the gas not as warm as the room at first, the piston at rest or not."""
    plant, time = vessel(), np.arange(N) * PERIOD
    command = np.where((time > 3.0) & (time < 3.3), 0.3, 0.0)
    start = run_of(np.full(N, 5e5), np.full(N, 3e5), time=time, length=0.1 + travel * np.sin(np.pi * time), command=command, commanded=True)
    predicted = run_gas(inputs(start, plant.world, 100.0), plant.world, plant.cylinder, warmth=warmth).pressure
    noisy = predicted + NOISE * np.random.default_rng(7).normal(size=predicted.shape)  # the same whatever was recorded before
    return replace(start, pressure=(noisy[:, 0], noisy[:, 1]), noise=(NOISE, NOISE))
