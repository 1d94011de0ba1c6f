"""Balances of forces in closed form: a mass on a slide or an arm on a hinge, moved to and fro."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.motion_run import Drive, Inertia, Kinematics, MotionRun, Passive
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.physics.plant_records import CYLINDER, WORLD

Array = NDArray[np.float64]

TIME = np.arange(8000, dtype=float) * 1e-3
MASS = 8.0
POSITION = 0.05 * np.sin(3.0 * TIME) + 0.02 * np.sin(7.3 * TIME)
VELOCITY = 0.15 * np.cos(3.0 * TIME) + 0.146 * np.cos(7.3 * TIME)
ACCELERATION = -0.45 * np.sin(3.0 * TIME) - 1.0658 * np.sin(7.3 * TIME)


def balance(lost: Array, noise: float = 0.0, turning: bool = False) -> MotionRun:
    """Return the balance of a joint without a cylinder whose outside force makes up for what is lost [N, N m]."""
    nothing, inertia = np.zeros(TIME.size), MASS * ACCELERATION
    force = inertia + lost + noise * np.random.default_rng(6).standard_normal(TIME.size)
    return MotionRun(
        recording="recording", joint="slide", turning=turning, time=TIME, breaks=(0,),
        kinematics=Kinematics(POSITION, VELOCITY, still=1e-3), inertia=Inertia(inertia, nothing, nothing, MASS),
        passive=Passive(nothing), drive=Drive(nothing, None, np.ones(TIME.size), np.zeros((TIME.size, 2)), {}), external=force,
        noise=max(noise, 1e-3), external_recorded=True,
    )  # fmt: skip


def behind_cylinder(run: MotionRun, gauge: Array) -> MotionRun:
    """Return a balance that the piston of a cylinder drives, with these pressures above the atmosphere, shape (n, 2) [Pa]."""
    drive = replace(run.drive, force=run.external, cylinder="piston", gauge=gauge)
    return replace(run, drive=drive, external=np.zeros(TIME.size), external_recorded=False)


def plant() -> PlantParameters:
    """Return a plant without friction, of a cylinder of 8 cm^2 at 7 bar."""
    world, cylinder = np.zeros(1, WORLD), np.zeros(1, CYLINDER)
    world["supply_pressure"], world["atmosphere"] = 7e5, 1e5
    cylinder["area_1"], cylinder["area_2"], cylinder["stroke"] = 8e-4, 7e-4, 0.2
    return PlantParameters(world, cylinder)
