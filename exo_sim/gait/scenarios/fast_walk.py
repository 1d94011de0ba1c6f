"""Fast walking: the recorded stride, longer and quicker."""

from functools import partial

from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.walking import walking

SCENARIO = Scenario(
    summary="fast walking at 1.6 m/s, the recorded stride scaled (Grieve and Gear)",
    motion=partial(walking, "falisse"),
    pace=1.6,
)
