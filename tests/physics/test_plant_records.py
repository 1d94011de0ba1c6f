"""Records have a field for every parameter of every effect, zero is off, and what is measured switches a shared effect off."""

from __future__ import annotations

import numpy as np

from exo_sim.physics.declaration import declared
from exo_sim.physics.plant_records import CYLINDER, JOINT, WORLD, switch_off
from exo_sim.physics.pneumatics import paper_world


def test_every_parameter_of_every_effect_has_a_place() -> None:
    kinds = {"cylinder": CYLINDER, "joint": JOINT, "supply": WORLD, "exhaust": WORLD}
    for effect in declared().values():
        for place in set(effect.places) & set(kinds):
            names = kinds[place][effect.name].names
            assert names == tuple(parameter.name for parameter in effect.parameters)


def test_records_are_whole_words_of_eight_bytes() -> None:
    assert all(kind.itemsize % 8 == 0 for kind in (CYLINDER, JOINT, WORLD))


def test_a_measured_supply_switches_off_what_makes_it_sag_and_nothing_else() -> None:
    world = paper_world()
    world["supply_droop"]["volume"], world["supply_regulator"]["droop"], world["exhaust_back_pressure"]["area"] = 1e-3, 2e7, 1e-6
    switch_off(world, {"supply"})
    assert not np.any(world["supply_droop"].view(np.float64)) and world["supply_regulator"]["droop"][0] == 0.0
    assert world["exhaust_back_pressure"]["area"][0] == 1e-6 and world["supply_pressure"][0] == 7e5
