"""One choice of actuators, and the space it is chosen from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RigError, ScenarioError, nearest
from exo_sim.machine.attachment import attachments
from exo_sim.machine.linkage import linkages
from exo_sim.machine.load import load
from exo_sim.rig import Attachment, EffectSetting, Rig
from exo_sim.rig.catalogue import CatalogueCylinder
from exo_sim.rig.own_catalogue import Catalogue, CatalogueValve
from exo_sim.sizing.linkage_geometry import length_and_arm

#: Part of the stroke that stays unused at each end [m].
END_CLEARANCE = 2e-3
#: Valve areas that are looked at [m^2].
VALVE_AREAS = (2e-6, 40e-6)
#: Lowest supply that is looked at, above the atmosphere [Pa].
LEAST_SUPPLY = 3e5
#: Most sizes above the smallest bore that suffices.
MOST_ABOVE = 2
#: Largest change of the angle between the two ends, seen from the joint [rad].
LARGEST_TURN = 0.6
#: What a workshop can tell apart: lengths [m], valve areas [m^2], pressures [Pa]. Designs are rounded to it before they are judged.
PLACES = {"length": 1e-4, "area": 1e-7, "pressure": 1e4}
#: What a kilogram of helical steel spring stores [J/kg]: 0.9 GPa of shear, half of the ideal bar's 0.32 kJ/kg for ends and reserve.
SPRING_ENERGY = 150.0
_RANGE_SAMPLES = 41


@dataclass(frozen=True)
class JointKind:
    """Cylinders that are sized alike: those of the left and the right hip, say.

    Attributes:
        name: "hip".
        cylinders: Their names.
        joints: The joints they drive, in the same order.
        across: Distance of a cylinder's ends along the joint's axis [m].
        own: The owner's attachment points.
        range: Of the joint [rad].
        direction: Sign of the owner's moment arm.
    """

    name: str
    cylinders: tuple[str, ...]
    joints: tuple[str, ...]
    across: float
    own: Attachment
    range: tuple[float, float]
    direction: float

    def sweep(self, attachment: Attachment) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return length and moment arm over the joint's range, the arm's sign as the owner's counted positive."""
        length, arm = length_and_arm(attachment, self.across, np.linspace(*self.range, _RANGE_SAMPLES))
        return length, arm * self.direction


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
    """

    supply: float
    joints: Mapping[str, JointDesign]
    number: int = -1


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


def kinds_of(rig: Rig, only: tuple[str, ...] = ()) -> tuple[JointKind, ...]:
    """Return the groups of cylinders that are sized alike, in the order of the rig.

    Args:
        rig: The owner's machine.
        only: Names of the joints to size; all that have cylinders when empty.

    Raises:
        RigError: no cylinder with a valve, or a joint without bounds.
        ScenarioError: `only` names a joint that no cylinder drives.
        ModelError: a cylinder without attachment points.
    """
    model = load(rig)
    data = mujoco.MjData(model)
    points = attachments(rig, model)
    groups: dict[str, list[tuple[str, str, int]]] = {}
    links = linkages(rig, model)
    driven = [link.joint for link in links]
    for joint in only:
        if joint not in driven:
            raise ScenarioError(f'--joints: no cylinder of {rig.path} drives "{joint}"{nearest(joint, driven)}')
    for link in links:
        if only and link.joint not in only:
            continue
        if not link.turning:
            raise RigError(
                f'{rig.path}: cylinders.{link.cylinder} drives the sliding joint "{link.joint}"; sizing is for '
                "cylinders that turn the joints of a worn machine"
            )
        stem = link.joint[:-2] if link.joint.endswith(("_l", "_r")) else link.joint
        groups.setdefault(stem, []).append((link.cylinder, link.joint, link.dof))
    if not groups:
        raise RigError(f"{rig.path}: there is no cylinder to size; give the rig a [cylinders.NAME] table")
    found = []
    for stem, members in groups.items():
        name, joint, dof = members[0]
        index = int(model.dof_jntid[dof])
        if not model.jnt_limited[index]:
            raise RigError(f'{rig.path}: joint "{joint}" of {rig.model.name} has no range, so no stroke covers it; give it one')
        low, high = (float(bound) for bound in model.jnt_range[index])
        middle = np.array([0.5 * (low + high)])
        flat, arm = length_and_arm(points[name], 0.0, middle)
        data.qpos[:] = model.qpos0
        data.qpos[model.jnt_qposadr[index]] = middle[0]
        mujoco.mj_forward(model, data)
        whole = float(data.actuator(rig.cylinders[name].actuator).length[0])
        across = float(np.sqrt(max(whole**2 - flat[0] ** 2, 0.0)))
        found.append(
            JointKind(
                stem, tuple(m[0] for m in members), tuple(m[1] for m in members), across if across > 1e-6 else 0.0,
                points[name], (low, high), float(np.sign(arm[0])) or 1.0,
            )
        )  # fmt: skip
    return tuple(found)


@dataclass(frozen=True)
class Space:
    """What may be chosen, as independent variables.

    Torque and travel of a cylinder depend on its attachment points through three numbers only: how far each end is from the
    joint's axis, and the angle between the two seen from there. These are the variables; an angle is shared evenly by both ends.
    The bore is asked as so many sizes above the smallest that carries the loads, so that most draws can be built.

    Attributes:
        kinds: Joints to size.
        supply: Least and largest supply pressure, absolute [Pa].
        reach: How far an end may move from the owner's, each way [m].
        catalogue: What may be bought.
        fixed: Numbers that are not to be chosen, by name: "supply", "hip.bore", "hip.valve", "hip.from", "hip.to".
        springs: Whether each rod may have a spring beside it; it is the one with which the gas is least (`springs.beside`).
    """

    kinds: tuple[JointKind, ...]
    supply: tuple[float, float]
    reach: float
    catalogue: Catalogue = field(default_factory=Catalogue)
    fixed: tuple[tuple[str, float], ...] = ()
    springs: bool = False

    def bores(self, kind: JointKind) -> tuple[int, ...]:
        """Return the places in the catalogue that a kind of joint may choose from, by rising bore."""
        wanted = dict(self.fixed).get(f"{kind.name}.bore")
        found = range(len(self.catalogue.cylinders))
        return tuple(i for i in found if wanted is None or abs(self.catalogue.cylinders[i].bore - wanted) < 1e-6)

    @property
    def limit(self) -> float:
        """Largest pressure that is allowed anywhere, absolute [Pa]."""
        return self.supply[1]

    @cached_property
    def valve_areas(self) -> tuple[float, float]:
        """Least and largest valve area [m^2]."""
        valves = self.catalogue.valves
        return (valves[0].area, valves[-1].area) if valves else VALVE_AREAS

    def valve(self, area: float) -> CatalogueValve | None:
        """Return the catalogue's valve nearest to an area, on a logarithmic scale; None where any area may be had."""
        valves = self.catalogue.valves
        return min(valves, key=lambda one: abs(np.log(one.area / area))) if valves else None

    @cached_property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """Bounds of the continuous variables, by name, in the order in which they are asked; valve areas by logarithm."""
        out = {"supply": self.supply}
        fixed = dict(self.fixed)
        for kind in self.kinds:
            radii = [float(np.hypot(*end)) for end in (kind.own.base, kind.own.rod)]
            for name, radius in zip(("from", "to"), radii):
                out[f"{kind.name}.{name}"] = (max(radius - self.reach, 0.01), radius + self.reach)
            turn = min(self.reach / min(radii), LARGEST_TURN)
            out[f"{kind.name}.turn"] = (-turn, turn)
            out[f"{kind.name}.valve"] = self.valve_areas
        return {name: (fixed[name], fixed[name]) if name in fixed else ends for name, ends in out.items()}

    def attachment(self, kind: JointKind, numbers: Mapping[str, float]) -> Attachment:
        """Return the points that a set of variables stands for."""
        half = 0.5 * float(numbers[f"{kind.name}.turn"])
        ends = []
        for name, end, angle in (("from", kind.own.base, -half), ("to", kind.own.rod, half)):
            way = np.arctan2(end[1], end[0]) + angle
            radius = float(numbers[f"{kind.name}.{name}"])
            ends.append((_to(radius * np.cos(way), PLACES["length"]), _to(radius * np.sin(way), PLACES["length"])))
        return Attachment(*ends)

    def design(
        self, numbers: Mapping[str, float], bores: Mapping[str, int], number: int = -1,
        springs: Mapping[str, tuple[float, float]] | None = None,
    ) -> Design:  # fmt: skip
        """Return the design that variables, bores (places in the catalogue) and springs by kind of joint stand for."""
        joints = {}
        for kind in self.kinds:
            area = float(numbers[f"{kind.name}.valve"])
            valve = self.valve(area)
            cylinder = self.catalogue.cylinders[bores[kind.name]]
            area = _to(area, PLACES["area"]) if valve is None else valve.area
            joints[kind.name] = JointDesign(cylinder, self.attachment(kind, numbers), area, valve, (springs or {}).get(kind.name))
        return Design(_to(numbers["supply"], PLACES["pressure"]), joints, number)

    def owners(self, rig: Rig) -> dict[str, float]:
        """Return the variables nearest to the owner's own machine, with the smallest bores that suffice."""
        out = {"supply": rig.supply.pressure}
        for kind in self.kinds:
            out[f"{kind.name}.above"] = 0.0
            out[f"{kind.name}.from"], out[f"{kind.name}.to"] = (
                float(np.hypot(*end)) for end in (kind.own.base, kind.own.rod)
            )
            out[f"{kind.name}.turn"] = 0.0
            out[f"{kind.name}.valve"] = rig.cylinders[kind.cylinders[0]].valve_area or self.valve_areas[0]
        for name, (low, high) in self.bounds.items():
            out[name] = min(max(out[name], low), high)
        return out


def _to(value: float, place: float) -> float:
    return float(np.round(float(value) / place)) * place


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
    return replace(rig, cylinders=cylinders, effects=effects, supply=replace(rig.supply, pressure=design.supply))


def with_valve(effects: tuple[EffectSetting, ...], kind: JointKind, chosen: JointDesign) -> tuple[EffectSetting, ...]:
    """Return effects with the lag and the critical ratio of a catalogue's valve, and a design's spring, in place of the owner's."""
    said = [(name, {parameter: value}) for name, parameter, value in valve_effects(chosen.valve)]
    if chosen.spring is not None:
        said.append(("return_spring", {"stiffness": chosen.spring[0], "rest": chosen.spring[1]}))
    for name, parameters in said:
        effects = tuple(one for one in effects if one.name != name or one.where not in kind.cylinders)
        effects += tuple(EffectSetting(name, cylinder, parameters) for cylinder in kind.cylinders)
    return effects


def valve_effects(valve: CatalogueValve | None) -> list[tuple[str, str, float]]:
    """Return effect, parameter and value of what a catalogue says of a valve besides its size."""
    if valve is None:
        return []
    said = (("valve_lag", "time_constant", valve.lag), ("critical_ratio", "ratio", valve.ratio))
    return [one for one in said if one[2] > 0.0]


def actuator_mass(kinds: tuple[JointKind, ...], design: Design) -> float:
    """Return the mass of all cylinders, springs and, where the catalogue says it, valves [kg], infinite where a stroke is not to be had."""
    total = 0.0
    for kind in kinds:
        chosen = design.joints[kind.name]
        stroke = fit(kind, chosen).stroke
        if stroke is None:
            return float(np.inf)
        valve = chosen.valve.mass if chosen.valve is not None else 0.0
        total += len(kind.cylinders) * (chosen.cylinder.mass(stroke) + valve + spring_mass(chosen.spring, stroke))
    return total


def spring_mass(spring: tuple[float, float] | None, stroke: float) -> float:
    """Return the mass of a steel spring that takes the whole stroke [kg], by what it stores (`SPRING_ENERGY`, our estimate)."""
    if spring is None:
        return 0.0
    stiffness, rest = spring
    return 0.5 * stiffness * max(abs(rest), abs(stroke - rest)) ** 2 / SPRING_ENERGY
