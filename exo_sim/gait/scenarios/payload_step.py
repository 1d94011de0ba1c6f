"""Standing still while somebody puts 20 kg more on the back."""

from exo_sim.gait.scenario_record import AddedLoad, Scenario
from exo_sim.gait.scenarios.stand import motion

SCENARIO = Scenario(
    summary="standing still; 20 kg are added half way",
    motion=motion,
    cycle="second",
    added=AddedLoad(mass=20.0, at=5.0, over=0.3),
)
