"""Standing still."""

import numpy as np

from exo_sim.gait.motion import SAMPLES, Motion
from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.standing import on_both_feet
from exo_sim.machine.person import Person


def motion(person: Person) -> Motion:
    """Stand with slightly bent knees, leaning against the load."""
    still = np.ones(SAMPLES)
    knee, ankle, lean = np.radians([-10.0, 7.0, 8.0])
    return on_both_feet(person, period=1.0, knee=knee * still, ankle=ankle * still, lean=lean * still)


SCENARIO = Scenario(summary="standing still", motion=motion, cycle="second")
