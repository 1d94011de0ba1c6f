"""Rising from a seat and sitting down again, every five seconds; the seat carries, the machine helps in between."""

import numpy as np

from exo_sim.gait.motion import Motion, phases, smooth
from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.standing import on_both_feet
from exo_sim.machine.person import Person


def motion(person: Person) -> Motion:
    """Lean forward, rise, stand, sit down again."""
    phase = phases()
    up = smooth((phase - 0.16) / 0.30) * smooth((0.96 - phase) / 0.30)
    lean = smooth((phase - 0.04) / 0.20) * smooth((0.52 - phase) / 0.26)
    lean += smooth((phase - 0.60) / 0.26) * smooth((1.10 - phase) / 0.22)
    lean += smooth((phase + 0.40) / 0.26) * smooth((0.10 - phase) / 0.22)
    return on_both_feet(
        person,
        period=5.0,
        knee=-np.radians(80.0 - 70.0 * up),
        ankle=np.radians(6.0 + 1.0 * up),
        lean=np.radians(8.0 + 22.0 * np.clip(lean, 0.0, 1.0)),
        support=smooth(up / 0.5),
    )


SCENARIO = Scenario(summary="rising from a seat and sitting down again, every 5 s", motion=motion, cycle="repetition")
