"""Walking on level ground with a tool hung on the left thigh of the machine beside the payload."""

from functools import partial

from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.walking import walking

SCENARIO = Scenario(
    summary="level walking with 3 kg on the machine's left thigh alone",
    motion=partial(walking, "falisse"),
    gait="falisse",
    hung={"thigh_l": 3.0},
)
