"""Rehearsed torques go by all that they follow from: whatever changes them changes what they are kept under."""

from dataclasses import replace

import pytest

from exo_sim import rig as rigs
from exo_sim.control.least_load import Weights
from exo_sim.control.valve_control import ValveGains
from exo_sim.rig import Rig
from exo_sim.simulation.rehearsed_before import identity
from exo_sim.simulation.walk import Request, default_rig
from exo_sim.simulation.worn import Simulation


def of(rig: Rig, request: Request, seed: int = 0) -> bytes:
    it = Simulation(rig, replace(request, rehearsals=0), seed=seed)
    it.request = request
    return identity(it, it.model, request.payload)


@pytest.fixture(scope="module")
def rig() -> Rig:
    return rigs.read(default_rig())


PLAIN = Request("level_walk", 34.0, cycles=3)


def test_the_same_walk_goes_under_the_same_name_however_long_it_is(rig: Rig) -> None:
    assert of(rig, PLAIN) == of(rig, PLAIN) == of(rig, replace(PLAIN, cycles=5)) == of(rig, PLAIN, seed=1)


def test_what_changes_torques_changes_the_name(rig: Rig) -> None:
    other_rigs = (
        replace(rig, ankle=replace(rig.ankle, stiffness=200.0)), replace(rig, supply=replace(rig.supply, pressure=8e5)),
        replace(rig, wearer=replace(rig.wearer, mass=80.0)), replace(rig, body_masses={**rig.body_masses, "torso": 10.0}),
    )  # fmt: skip
    measured = replace(PLAIN, signals="measured")
    requests = (
        replace(PLAIN, payload=20.0), replace(PLAIN, speed=1.1), replace(PLAIN, controller="pi"), replace(PLAIN, rehearsals=3),
        replace(PLAIN, weights=Weights(hip=2.0)), replace(PLAIN, gains=ValveGains(preview=0.001)), replace(PLAIN, scenario="slow_walk"),
        replace(PLAIN, step=0.002), replace(PLAIN, ideal=True), measured,
        replace(PLAIN, wearer="torques"),
    )  # fmt: skip
    names = [of(rig, PLAIN), *(of(other, PLAIN) for other in other_rigs), *(of(rig, request) for request in requests), of(rig, measured, 1)]
    assert len(set(names)) == len(names)
