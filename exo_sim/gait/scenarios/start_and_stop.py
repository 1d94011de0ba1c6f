"""Walking off from stance, six steps, and coming to rest."""

from functools import partial

from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.start_and_stop import start_and_stop

SCENARIO = Scenario(
    summary="from stance six steps at up to 1.2 m/s, and to rest, drawn from the recorded stride (Falisse)",
    motion=partial(start_and_stop, "falisse"),
    cycle="walk",
    cycles=3,
)
