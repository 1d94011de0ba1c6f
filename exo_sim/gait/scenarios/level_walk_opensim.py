"""Walking as recorded on a treadmill in OpenSim's Gait10dof18musc example."""

from functools import partial

from exo_sim.gait.scenario_record import Scenario
from exo_sim.gait.walking import walking

SCENARIO = Scenario(
    summary="level walking at 1.0 m/s, mean of three recorded treadmill strides (OpenSim)",
    motion=partial(walking, "opensim"),
    gait="opensim",
)
