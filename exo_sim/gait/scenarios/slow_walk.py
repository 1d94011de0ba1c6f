"""Slow walking: the recorded stride, shorter and slower."""

from functools import partial

from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.walking import walking

SCENARIO = Scenario(
    summary="slow walking at 0.7 m/s, the recorded stride scaled (Grieve and Gear)",
    motion=partial(walking, "falisse"),
    pace=0.7,
)
