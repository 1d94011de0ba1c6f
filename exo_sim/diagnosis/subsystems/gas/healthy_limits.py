"""How much of an effect on the gas a healthy machine has at most, and what its slow losses do to a plant."""

from __future__ import annotations

import math

from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.policy import healthy
from exo_sim.diagnosis.subsystems.healthy_leak import BY_UNIT, swept_volume
from exo_sim.physics.declaration import Effect, Parameter, declared


def healthy_limit(effect: Effect, parameter: Parameter, plant: PlantParameters) -> float:
    """Return how much of a parameter a healthy machine has at most."""
    c = plant.cylinder[0]
    if effect.identification.leaks and parameter.unit in BY_UNIT:
        return effect.identification.leaks * BY_UNIT[parameter.unit] * swept_volume(plant)
    if effect.identification.wall_heat:
        bore = math.sqrt(4.0 * float(c["area_1"]) / math.pi)
        return effect.identification.wall_heat * healthy.FILM * math.pi * bore * (float(c["stroke"]) + 0.5 * bore)
    return effect.identification.smallest(parameter.name)


def with_healthy_losses(plant: PlantParameters) -> tuple[PlantParameters, ...]:
    """Return the plant with each slow loss of gas or heat that it does not have as a healthy machine has it, one at a time.

    Over a window such a loss hides in the noise, over a whole recording it adds up.
    """
    valve, single = float(plant.cylinder["valve_area"][0]) > 0.0, float(plant.cylinder["single_acting"][0]) > 0.0
    found = []
    for effect in declared().values():
        declares, sense = effect.identification, effect.identification.applicability
        if effect.cut != "gas" or not (declares.leaks or declares.wall_heat) or plant.is_on(effect):
            continue
        if (sense.commanded and not valve) or (sense.two_chambers and single):
            continue
        for parameter in effect.parameters:
            of_both = declares.wall_heat and parameter is effect.parameters[0]
            of_one = declares.leaks and parameter.unit == "m^2" and not (single and parameter.name.endswith("_2"))
            if of_both or of_one:
                more = plant.copy()
                more.cylinder[effect.name][parameter.name] = healthy_limit(effect, parameter, plant)
                found.append(more)
    return tuple(found)
