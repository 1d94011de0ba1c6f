"""The worn machine that comes along, of cylinders that can be bought: within rating and stroke, and a relief with all that it weighs."""

import dataclasses

import pytest

from exo_sim import rig as rigs
from exo_sim.rig.catalogue import estimated_mass, find
from exo_sim.rig.limits import rating
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request, default_rig
from exo_sim.simulation.worn import Simulation


@pytest.fixture(scope="module")
def rig():
    return rigs.read(default_rig())


def test_its_cylinders_are_in_the_catalogue_and_fit_between_their_pivots(rig):
    for cylinder in rig.cylinders.values():
        entry = find(cylinder.bore, cylinder.rod)
        assert entry is not None and cylinder.stroke in entry.strokes
        assert entry.shortest(cylinder.stroke) <= cylinder.retracted_length
        allowed = rating(rig, cylinder)
        assert allowed is not None and rig.supply.pressure < allowed[0]


def test_its_bodies_carry_the_cylinders_their_mountings_and_valves(rig):
    cylinders = sum(estimated_mass(one) for one in rig.cylinders.values())
    mountings = 2 * (0.58 + 0.42)
    simulation = Simulation(rig, Request("stand", 0.0, law="inverse_dynamics"))
    bare = Simulation(dataclasses.replace(rig, body_masses={}), Request("stand", 0.0, law="inverse_dynamics"))
    heavier = simulation.model.body_mass.sum() - bare.model.body_mass.sum()
    assert heavier == pytest.approx(cylinders + mountings + 4 * 0.55, abs=0.05)


@pytest.mark.parametrize(
    ("scenario", "payload"),
    [("level_walk", 34.0), ("level_walk", 45.0), ("slow_walk", 34.0), ("uneven_load", 34.0), ("sit_to_stand", 45.0)],
)
def test_it_stays_within_rating_and_stroke(rig, scenario, payload):
    cycles = 1 if scenario == "sit_to_stand" else 6
    simulation = Simulation(rig, Request(scenario, payload, cycles=cycles))
    assert simulation.remarks == ()
    summary = summarise(simulation.run())
    assert not [words for words in summary.get("warnings", ()) if "rating" in words or "stroke" in words or "rated" in words]
    if scenario != "sit_to_stand":
        assert summary["wearer"]["metabolic_w"]["value"] < summary["compared_with"]["backpack"]["metabolic_w"]


def test_what_passes_the_rating_is_said(rig):
    """Down a slope the knee's piston is pushed back against gas that is shut in; docs/walking.md has how far."""
    summary = summarise(Simulation(rig, Request("slope_down", 34.0, cycles=4)).run())
    peak = max(one["pressure_peak_pa"] for one in summary["cylinders"].values())
    allowed = min(limits[0] for one in rig.cylinders.values() if (limits := rating(rig, one)) is not None)
    assert any("rated" in words for words in summary.get("warnings", ())) == (peak > allowed)
    assert summary["wearer"]["metabolic_w"]["value"] < summary["compared_with"]["backpack"]["metabolic_w"]
