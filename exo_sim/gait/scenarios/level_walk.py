"""Walking on level ground with the mean of eleven recorded strides."""

from functools import partial

from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.walking import walking

SCENARIO = Scenario(
    summary="level walking at 1.2 m/s, mean of eleven recorded strides (Falisse)",
    motion=partial(walking, "falisse"),
    gait="falisse",
)
