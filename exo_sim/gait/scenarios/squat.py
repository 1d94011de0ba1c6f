"""Squatting down and rising, one every three seconds, thighs nearly level at the bottom."""

import numpy as np

from exo_sim.gait.motion import Motion, phases
from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.standing import on_both_feet
from exo_sim.machine.person import Person


def motion(person: Person) -> Motion:
    """Bend knee, ankle and torso together, so that the load stays over the feet."""
    depth = 0.5 * (1.0 - np.cos(2 * np.pi * phases()))
    return on_both_feet(
        person,
        period=3.0,
        knee=-np.radians(10.0 + 90.0 * depth),
        ankle=np.radians(7.0 + 18.0 * depth),
        lean=np.radians(8.0 + 22.0 * depth),
    )


SCENARIO = Scenario(summary="deep squats, one every 3 s", motion=motion, cycle="repetition")
