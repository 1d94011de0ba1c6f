"""What can be asked of a supply: each declared effect of it that the rig has not on, inside its bounds."""

from __future__ import annotations

import numpy as np

from exo_sim.diagnosis.estimation.parameters import PlantParameters, Target
from exo_sim.diagnosis.subsystems.supply.candidates import candidates, nuisance_parameters
from exo_sim.physics.declaration import declared
from exo_sim.physics.plant_records import CYLINDER, WORLD


def plant(**on: dict[str, float]) -> PlantParameters:
    world = np.zeros(1, WORLD)
    world["supply_pressure"] = 7e5
    for effect, numbers in on.items():
        for name, value in numbers.items():
            world[effect][name] = value
    return PlantParameters(world, np.zeros(1, CYLINDER))


def test_every_effect_of_the_supply_is_asked_and_starts_lie_inside_what_is_met() -> None:
    asked = candidates(plant())
    assert {one.effect for one in asked} == {"supply_droop", "supply_regulator"}
    for one in asked:
        typical = {p.name: p.typical for p in declared()[one.effect].parameters}
        assert one.where == "supply" and len(one.starts) == 3 ** len(one.parameters)
        for start in one.starts:
            for q, value in zip(one.parameters, start, strict=True):
                assert q.target is Target.WORLD and typical[q.parameter][0] < value < typical[q.parameter][1]


def test_what_the_rig_has_on_already_is_not_asked() -> None:
    assert {one.effect for one in candidates(plant(supply_droop={"volume": 2e-3}))} == {"supply_regulator"}


def test_the_set_pressure_is_free_around_what_the_rig_says() -> None:
    (one,) = nuisance_parameters(plant())
    assert one.prior is not None and one.prior[0] == 0.0 and 0.0 < one.prior[1] < 0.1 * 7e5 and one.start == 0.0
