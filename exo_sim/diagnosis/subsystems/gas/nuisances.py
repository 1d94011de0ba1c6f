"""Nuisance parameters of the gas: what a data sheet leaves open and what every healthy machine shows, free in every fit."""

from __future__ import annotations

import math
from collections.abc import Sequence

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.nominal_numbers import DEAD_VOLUME, FLOW_CAPACITY, POSITION_DELAY, SET_PRESSURE, ZERO
from exo_sim.diagnosis.policy import healthy, priors
from exo_sim.diagnosis.subsystems.gas.place import measured_places, place_of
from exo_sim.physics.declaration import declared
from exo_sim.physics.plant_records import switch_off


def nuisance_parameters(
    plant: PlantParameters, cylinder: str, commanded: bool, sides: Sequence[int], at_rest: bool = False, moves: bool = False,
    supplied: bool = False, period: float = 0.0,
) -> tuple[FreeParameter, ...]:
    """Return the nuisance parameters of a cylinder's gas.

    They are factors on valve area and dead volumes, the zeros of the pressure sensors, and the imperfections of a healthy valve. A gas
    at rest also loses heat to its walls, in every machine: where nothing else happens that is no finding.

    Args:
        plant: The nominal machine.
        cylinder: Its name.
        commanded: Whether a valve command was recorded; without one the valve has no free parameter.
        sides: Chambers whose pressure was recorded, of 1 and 2.
        at_rest: Whether neither valve nor piston ever moves.
        moves: Whether the piston moves: then the card of its position may be late.
        supplied: Whether the supply's pressure was recorded; without that the set pressure is a nominal number like others, and both
            pressures would seem to have a wrong gain in its place.
        period: Of the samples [s]: a valve's dead time shorter than that is not distinguished from the filter of a slow logger's card.
    """
    factors = tuple(
        FreeParameter(effect, cylinder, name, "1", Target.FACTOR, 0.1, 0.05, 10.0, (1.0, spread), neutral=1.0)
        for effect, name, spread in (
            (FLOW_CAPACITY, "valve_area", priors.VALVE_AREA),
            (DEAD_VOLUME, "dead_volume_1", priors.DEAD_VOLUME),
            (DEAD_VOLUME, "dead_volume_2", priors.DEAD_VOLUME),
        )
        if commanded or name != "valve_area"
    )
    zeros = tuple(
        FreeParameter(
            ZERO, f"{cylinder}.pressure_{side}", f"pressure_{side}.bias", "Pa", Target.SENSOR, priors.PRESSURE_ZERO, -1e4, 1e4,
            (0.0, priors.PRESSURE_ZERO),
        )  # fmt: skip
        for side in sides
    )
    if moves:
        skew, most = priors.CARD_SKEW, healthy.MOST_CARD_SKEW
        zeros += (FreeParameter("card_delay", cylinder, POSITION_DELAY, "s", Target.SENSOR, skew, -most, most, (0.0, skew)),)
    if commanded and not supplied:
        widest, spread = 1.0 - float(priors.SENSOR_SCALE_LEAST), priors.SET_PRESSURE
        zeros += (
            FreeParameter(
                SET_PRESSURE, "supply", "supply.scale", "1", Target.SENSOR, spread, 1.0 - widest, 1.0 + widest, (1.0, spread), neutral=1.0
            ),
        )  # fmt: skip
    zeros += healthy_walls(plant, cylinder) if at_rest else ()
    return (*factors, *zeros, *_valve_imperfections(plant, cylinder, period)) if commanded else (*factors, *zeros)


def healthy_walls(plant: PlantParameters, cylinder: str) -> tuple[FreeParameter, ...]:
    """Return the heat that walls take from the gas in every machine, where the rig says nothing of it."""
    heat = priors.REST_HEAT
    return tuple(
        FreeParameter(effect.name, cylinder, effect.parameters[0].name, "W/K", Target.CYLINDER, heat, 0.0, 20.0 * heat, (0.0, heat))
        for effect in declared().values()
        if effect.identification.wall_heat and not plant.is_on(effect)
    )


def _valve_imperfections(plant: PlantParameters, cylinder: str, period: float) -> tuple[FreeParameter, ...]:
    """Return what a healthy valve shows of the effects that the rig does not have on already, in this form or a richer one.

    Of an effect that the rig has on these are the numbers that it leaves out.
    """
    found = []
    contained, single = plant.contained_effects, float(plant.cylinder["single_acting"][0]) > 0.0
    for effect in declared().values():
        if effect.name in contained:
            continue
        for name, (spread, most) in effect.identification.healthy.items():
            parameter = effect.parameter(name)
            if float(plant.cylinder[effect.name][name][0]) != 0.0 or (single and name.endswith("_2")):
                continue
            if parameter.unit == "s":
                spread, most = max(spread, 0.5 * period), max(most, period)
            low = 0.0 if parameter.low >= 0.0 else -most
            found.append(
                FreeParameter(
                    effect.name, cylinder, name, parameter.unit, Target.CYLINDER, spread, low, most, (0.0, spread),
                    nonsmooth=effect.identification.jerky and not name.startswith("excess"),
                )  # fmt: skip
            )
    return tuple(found)


def known_effects(plant: PlantParameters, cylinder: str, period: float = 0.0) -> tuple[FreeParameter, ...]:
    """Return the parameters of effects that the rig has on already: an owner's numbers are estimates.

    Times are known no better than the clocks of the columns that show them: those of two cards, and a command that changes within a
    sample; other numbers no better than what a healthy machine shows beside them.

    Args:
        plant: The nominal machine.
        cylinder: Its name.
        period: Of the samples [s].
    """
    found, clocks = [], math.hypot(priors.CARD_SKEW, 0.5 * period)
    for effect in declared().values():
        if effect.cut != "gas":
            continue
        where, target = place_of(effect, cylinder)
        for name, value in plant.numbers_of(effect).items():
            parameter = effect.parameter(name)
            if not parameter.choices:
                beside = clocks if parameter.unit == "s" else effect.identification.beside(parameter.name)
                spread = math.hypot(priors.KNOWN_GAS * value, beside)
                found.append(
                    FreeParameter(
                        effect.name, where, parameter.name, parameter.unit, target, spread, parameter.low, parameter.high,
                        (value, spread), nonsmooth=effect.identification.jerky,
                    )  # fmt: skip
                )
    return tuple(found)


def with_measured_supply(plant: PlantParameters, runs: Sequence[CylinderRun]) -> PlantParameters:
    """Return a plant without the effects of supply and exhaust where these were measured: the measured pressure contains them."""
    measured = plant.copy()
    switch_off(measured.world, measured_places(runs))
    return measured
