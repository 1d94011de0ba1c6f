"""What counts as a large force and a long travel where something resists a motion."""

from __future__ import annotations

import numpy as np

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.estimation.parameters import PlantParameters


def full_force(run: MotionRun, plant: PlantParameters) -> float:
    """Return the force by which what resists is called small or large [N, N m at the joint].

    It is what the supply presses on the piston. Where no cylinder drives the balance, or forces of other origin are larger, it is the
    greatest that acted; nil in a swing that nothing drives, where any friction is all that takes energy.
    """
    acted = float(np.percentile(np.abs(run.driving), 99.0))
    if run.cylinder is None:
        return acted
    gauge = float(plant.world["supply_pressure"][0] - plant.world["atmosphere"][0])
    return max(gauge * float(plant.cylinder["area_1"][0]) * run.drive.usual_arm, acted)


def full_travel(run: MotionRun, plant: PlantParameters) -> tuple[float, float]:
    """Return the ends of the travel at which what resists is asked for: the stroke, or without a cylinder what the joint went through."""
    if run.cylinder is None:
        return float(np.min(run.kinematics.position)), float(np.max(run.kinematics.position))
    return 0.0, float(plant.cylinder["stroke"][0])
