"""Where the plan's torques cannot be held: with an ankle that has neither spring nor actuator."""

import dataclasses

import pytest

from exo_sim import rig as rigs
from exo_sim.rig import Ankle
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request, default_rig
from exo_sim.simulation.worn import Simulation


@pytest.mark.parametrize(("mode", "watts", "push"), [("free", 700.0, 70.0), ("powered", 480.0, 20.0)])
def test_a_plan_that_actuators_cannot_hold_gives_way_to_inverse_dynamics(mode: str, watts: float, push: float) -> None:
    """The free ankle cost 902 W with hips of 77 N m, the powered one pushed its wearer with 36 N."""
    rig = dataclasses.replace(rigs.read(default_rig()), ankle=Ankle(mode))
    wearer = summarise(Simulation(rig, Request("level_walk", 34.0, cycles=5)).run())["wearer"]
    assert wearer["metabolic_w"]["value"] < watts and abs(wearer["forward_push_n"]) < push
    assert wearer["moment_rms_nm"]["hip"] < 40.0
