"""Walking up a slope, feet on it as on level ground."""

from functools import partial

from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.walking import walking

SCENARIO = Scenario(
    summary="walking up a slope of 10 % at 1.2 m/s, drawn from the level walk",
    motion=partial(walking, "falisse"),
    grade=0.10,
)
