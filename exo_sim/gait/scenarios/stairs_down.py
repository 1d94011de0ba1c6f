"""Walking down stairs, one foot a tread."""

from functools import partial

from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.stairs import DOWN, walking_stairs

SCENARIO = Scenario(
    summary="walking down stairs of 170 by 290 mm, 100 treads a minute, drawn",
    motion=partial(walking_stairs, DOWN),
)
