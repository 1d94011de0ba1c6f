"""What a search may choose from: independent variables, their bounds, and the design that a set of them stands for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from exo_sim.rig import Attachment, Recovery, Rig
from exo_sim.rig.own_catalogue import Catalogue, CatalogueValve
from exo_sim.sizing.design import PLACES, Design, JointDesign
from exo_sim.sizing.joint_kinds import JointKind

#: Valve areas that are looked at [m^2].
VALVE_AREAS = (2e-6, 40e-6)
#: Lowest supply that is looked at, above the atmosphere [Pa].
LEAST_SUPPLY = 3e5
#: Pressures of a recovery tank that are looked at, as shares of the way from the atmosphere to the supply.
TANK_SHARES = (0.08, 0.6)
#: Most sizes above the smallest bore that suffices.
MOST_ABOVE = 2
#: Largest change of the angle between the two ends, seen from the joint [rad].
LARGEST_TURN = 0.6


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
        fixed: Numbers that are not to be chosen, by name: "supply", "hip.bore", "hip.valve", "hip.from", "hip.to", "tank".
        springs: Whether each rod may have a spring beside it; it is the one with which the gas is least (`springs.beside`).
        tank: Volume of a recovery tank [m^3]; 0 for none. Its pressure is chosen.
        atmosphere: [Pa].
    """

    kinds: tuple[JointKind, ...]
    supply: tuple[float, float]
    reach: float
    catalogue: Catalogue = field(default_factory=Catalogue)
    fixed: tuple[tuple[str, float], ...] = ()
    springs: bool = False
    tank: float = 0.0
    atmosphere: float = 101325.0

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
        if self.tank > 0.0:
            low, high = (self.atmosphere + share * (end - self.atmosphere) for share, end in zip(TANK_SHARES, self.supply))
            out["tank"] = (low, high)
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
        supply = _to(numbers["supply"], PLACES["pressure"])
        return Design(supply, joints, number, self._recovery(numbers, supply))

    def _recovery(self, numbers: Mapping[str, float], supply: float) -> Recovery | None:
        """Return the recovery tank, its pressure inside what a supply allows."""
        if self.tank <= 0.0:
            return None
        low, high = (self.atmosphere + share * (supply - self.atmosphere) for share in TANK_SHARES)
        return Recovery(self.tank, _to(min(max(float(numbers["tank"]), low), high), PLACES["pressure"]))

    def owners(self, rig: Rig) -> dict[str, float]:
        """Return the variables nearest to the owner's own machine, with the smallest bores that suffice."""
        out = {"supply": rig.supply.pressure}
        if self.tank > 0.0:
            out["tank"] = rig.recovery.pressure if rig.recovery is not None else 3.0 * self.atmosphere
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
