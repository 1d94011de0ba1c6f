"""A worn machine that walks off from stance and comes to rest: it is carried, its books balance, and what is refused."""

import dataclasses

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import ScenarioError
from exo_sim.gait import scenario
from exo_sim.gait.variation import Variation
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation


@pytest.fixture(scope="module")
def exo(repository):
    return rigs.read(repository / "assets" / "exo_250_psi.toml")


@pytest.fixture(scope="module")
def walk(exo):
    return Simulation(exo, Request("start_and_stop", 34.0, cycles=2, rehearsals=16)).run()  # after 6 the machine still swings


def test_it_walks_off_and_stands_again(walk):
    speed = walk.columns["torso_x.velocity"]
    period = walk.motion.period
    middle = (walk.time % period > 0.45 * period) & (walk.time % period < 0.6 * period)
    rests = (walk.time % period < 0.1 * period) & (walk.time > 0.5 * period)
    assert speed[middle].mean() > 1.0 and np.abs(speed[rests]).max() < 0.2
    assert walk.columns["torso_x.position"][-1] - walk.columns["torso_x.position"][0] == pytest.approx(2 * walk.motion.advance, abs=0.05)


def test_its_books_balance_and_a_plan_over_all_of_it_helps(walk):
    numbers = summarise(walk)
    carried = numbers["mean_ground_force_n"] + numbers["strap_load_n"]["vertical_mean"]
    assert carried == pytest.approx(numbers["supported_weight_n"], rel=0.03)
    assert abs(numbers["ledger"]["closure"]) < 1.0
    cost = numbers["compared_with"]
    assert cost["no_machine"]["metabolic_w"] < numbers["wearer"]["metabolic_w"]["value"] < cost["backpack"]["metabolic_w"]


def test_strides_that_come_again_are_asked_for(exo):
    with pytest.raises(ScenarioError, match="start_and_stop: demand \"causal\" goes by the phase"):
        Simulation(exo, Request("start_and_stop", 20.0, law="causal"))
    given = dataclasses.replace(scenario.find("start_and_stop"), variation=Variation(0.02))
    with pytest.raises(ScenarioError, match="leave out the variation"):
        Simulation(exo, Request("mine", 20.0, law="inverse_dynamics", given=given))
