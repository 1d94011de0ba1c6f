"""One choice of actuators, put on its machine: strokes, lengths, masses, and the rig that has it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from exo_sim.errors import RigError
from exo_sim.rig import Attachment, EffectSetting, Recovery, Rig
from exo_sim.rig.catalogue import CatalogueCylinder
from exo_sim.rig.own_catalogue import CatalogueValve
from exo_sim.sizing.joint_kinds import JointKind

#: Part of the stroke that stays unused at each end [m].
END_CLEARANCE = 2e-3
#: What a workshop can tell apart: lengths [m], valve areas [m^2], pressures [Pa]. Designs are rounded to it before they are judged.
PLACES = {"length": 1e-4, "area": 1e-7, "pressure": 1e4}
#: What a kilogram of helical steel spring stores [J/kg]: 0.9 GPa of shear, half of the ideal bar's 0.32 kJ/kg for ends and reserve.
SPRING_ENERGY = 150.0
#: What a recovery tank weighs for its volume [kg/m^3], and the two more paths of each cylinder to it [kg]: our estimates, of thin aluminium
#: tanks for 10 bar and of 2/2 valves of these sizes.
TANK_MASS, TANK_VALVES_MASS = 300.0, 0.2


@dataclass(frozen=True)
class JointDesign:
    """One joint's actuator.

    Attributes:
        cylinder: The catalogue's.
        attachment: Where it hangs.
        valve_area: Of each path of its valve [m^2].
        valve: Which of the catalogue's that is, if any.
        spring: Stiffness [N/m] and rest [m from X = 0] of a spring beside the rod, if any.
    """

    cylinder: CatalogueCylinder
    attachment: Attachment
    valve_area: float
    valve: CatalogueValve | None = None
    spring: tuple[float, float] | None = None


@dataclass(frozen=True)
class Design:
    """One choice.

    Attributes:
        supply: Absolute [Pa].
        joints: By kind.
        number: Of the trial, or -1.
        recovery: The recovery tank, if any.
    """

    supply: float
    joints: Mapping[str, JointDesign]
    number: int = -1
    recovery: Recovery | None = None


@dataclass(frozen=True)
class Fit:
    """A joint's design on its machine.

    Attributes:
        stroke: The catalogue's shortest that covers the joint's range [m], or None.
        retracted: Distance of the pivots at X = 0 [m].
        travel: What the joint's range asks for [m].
        least_arm: Over the joint's range [m]; negative past a dead centre.
        longest: Distance of the pivots at the far end of the range [m].
    """

    stroke: float | None
    retracted: float
    travel: float
    least_arm: float
    longest: float


def fit(kind: JointKind, design: JointDesign) -> Fit:
    """Return stroke and lengths that the attachment points ask of a cylinder."""
    length, arm = kind.sweep(design.attachment)
    travel = float(length.max() - length.min())
    return Fit(
        stroke=design.cylinder.stroke_for(travel + 2 * END_CLEARANCE + PLACES["length"]),
        retracted=float(np.floor((length.min() - END_CLEARANCE) / PLACES["length"]) * PLACES["length"]),
        travel=travel,
        least_arm=float(arm.min()),
        longest=float(length.max()),
    )


def fitted(rig: Rig, kinds: tuple[JointKind, ...], design: Design) -> Rig:
    """Return the rig with a design's cylinders, valves, attachment points and supply; everything else as it was.

    Raises:
        RigError: no catalogue stroke covers a joint's range.
    """
    cylinders, effects = dict(rig.cylinders), rig.effects
    for kind in kinds:
        chosen = design.joints[kind.name]
        effects = with_valve(effects, kind, chosen)
        place = fit(kind, chosen)
        if place.stroke is None:
            raise RigError(f"no stroke of the catalogue covers {place.travel * 1e3:.0f} mm at the {kind.name}")
        entry = chosen.cylinder
        dead_1, dead_2 = entry.dead_volumes()
        for name in kind.cylinders:
            cylinders[name] = replace(
                cylinders[name], bore=entry.bore, rod=entry.rod, stroke=place.stroke, retracted_length=place.retracted,
                dead_volume_1=dead_1, dead_volume_2=dead_2, valve_area=chosen.valve_area, attachment=chosen.attachment,
                rating=entry.rating,
            )  # fmt: skip
    supply = replace(rig.supply, pressure=design.supply)
    return replace(rig, cylinders=cylinders, effects=effects, supply=supply, recovery=design.recovery)


def with_valve(effects: tuple[EffectSetting, ...], kind: JointKind, chosen: JointDesign) -> tuple[EffectSetting, ...]:
    """Return effects with the lag and the critical ratio of a catalogue's valve, and a design's spring, in place of the owner's."""
    said = [(name, {parameter: value}) for name, parameter, value in valve_effects(chosen.valve)]
    if chosen.spring is not None:
        said.append(("return_spring", {"stiffness": chosen.spring[0], "rest": chosen.spring[1]}))
    return with_effects(effects, kind.cylinders, said)


def with_effects(
    effects: tuple[EffectSetting, ...], cylinders: tuple[str, ...], said: list[tuple[str, dict[str, float]]]
) -> tuple[EffectSetting, ...]:
    """Return effects with those of some cylinders in place of the owner's: name and parameters each."""
    for name, parameters in said:
        effects = tuple(one for one in effects if one.name != name or one.where not in cylinders)
        effects += tuple(EffectSetting(name, cylinder, parameters) for cylinder in cylinders)
    return effects


def valve_effects(valve: CatalogueValve | None) -> list[tuple[str, str, float]]:
    """Return effect, parameter and value of what a catalogue says of a valve besides its size."""
    if valve is None:
        return []
    said = (("valve_lag", "time_constant", valve.lag), ("critical_ratio", "ratio", valve.ratio))
    return [one for one in said if one[2] > 0.0]


def actuator_mass(kinds: tuple[JointKind, ...], design: Design) -> float:
    """Return the mass of all cylinders, springs, a recovery tank and, where the catalogue says it, valves [kg].

    Infinite where a stroke is not to be had.
    """
    total = recovery_mass(kinds, design)
    for kind in kinds:
        chosen = design.joints[kind.name]
        stroke = fit(kind, chosen).stroke
        if stroke is None:
            return float(np.inf)
        valve = chosen.valve.mass if chosen.valve is not None else 0.0
        total += len(kind.cylinders) * (chosen.cylinder.mass(stroke) + valve + spring_mass(chosen.spring, stroke))
    return total


def recovery_mass(kinds: tuple[JointKind, ...], design: Design) -> float:
    """Return the mass of a recovery tank and of the paths to it [kg], 0 where there is none (`TANK_MASS`, our estimate)."""
    if design.recovery is None:
        return 0.0
    return tank_mass(design) + TANK_VALVES_MASS * sum(len(kind.cylinders) for kind in kinds)


def tank_mass(design: Design) -> float:
    """Return the mass of a recovery tank alone [kg], 0 where there is none (`TANK_MASS`, our estimate)."""
    return 0.0 if design.recovery is None else TANK_MASS * design.recovery.volume


def spring_mass(spring: tuple[float, float] | None, stroke: float) -> float:
    """Return the mass of a steel spring that takes the whole stroke [kg], by what it stores (`SPRING_ENERGY`, our estimate)."""
    if spring is None:
        return 0.0
    stiffness, rest = spring
    return 0.5 * stiffness * max(abs(rest), abs(stroke - rest)) ** 2 / SPRING_ENERGY
