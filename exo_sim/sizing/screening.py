"""Whether a design can carry the loads at all: geometry, stroke, buckling, and torque at speed. No simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.rig import Rig, assembly
from exo_sim.sizing.capability import Capability, capability, margin
from exo_sim.sizing.design import Design, fit, fitted
from exo_sim.sizing.design_space import Space
from exo_sim.sizing.joint_kinds import JointKind
from exo_sim.sizing.length_and_arm import length_and_arm
from exo_sim.sizing.loads import JointLoads

#: Least moment arm over the joint's whole range [m]: below it a linkage counts as singular.
LEAST_ARM = 0.010
#: Phases of each joint's cycle at which torque is held against capability; those of a second leg lie between the first's.
_PHASES = 32
#: Constraints of each kind of joint, in this order; a design can be built where none is above zero.
CONSTRAINTS = ("dead centre", "stroke", "length", "buckling", "rating", "torque")
_MISSING = 1.0


@dataclass(frozen=True)
class Thinnest:
    """Where the margin is thinnest: which joint, under which condition, at which phase of the cycle (0 to 1)."""

    joint: str
    condition: str
    phase: float


@dataclass(frozen=True)
class Screened:
    """What screening says.

    Attributes:
        violations: By kind of joint and constraint, shares; above zero is violated. Flat, in the order of kinds, then `CONSTRAINTS`.
        margin: Least torque left, as a share of the joint's peak torque, over joints and conditions.
        by_joint: The same by kind of joint.
        thinnest: Where that is.
    """

    violations: tuple[float, ...]
    margin: float
    by_joint: Mapping[str, float]
    thinnest: Thinnest | None

    @property
    def survives(self) -> bool:
        """Whether the design is worth simulating."""
        return max(self.violations) <= 0.0


def screen(rig: Rig, kinds: tuple[JointKind, ...], loads: tuple[JointLoads, ...], design: Design) -> Screened:
    """Hold a design against the loads.

    Args:
        rig: The owner's machine; its effects count.
        kinds: Joints to size.
        loads: What they must carry, by condition.
        design: The choice.
    """
    geometry = []
    for kind in kinds:
        chosen = design.joints[kind.name]
        place = fit(kind, chosen)
        entry = chosen.cylinder
        stroke = place.stroke if place.stroke is not None else entry.strokes[-1]
        push = (design.supply - rig.environment.pressure) * np.pi / 4 * entry.bore**2
        geometry.append([
            (LEAST_ARM - place.least_arm) / LEAST_ARM,
            0.0 if place.stroke is not None else (place.travel - entry.strokes[-1]) / entry.strokes[-1] + _MISSING,
            (entry.shortest(stroke) - place.retracted) / entry.shortest(stroke),
            push / entry.buckling_force(place.longest) - 1.0,
            design.supply / entry.rating - 1.0,
        ])  # fmt: skip
    sound = [kind for kind, row in zip(kinds, geometry) if max(row) <= 0.0]
    least: tuple[float, Thinnest | None] = (-_MISSING if len(sound) < len(kinds) else np.inf, None)
    by_joint = {kind.name: -_MISSING for kind in kinds}
    chosen_rig = fitted(rig, tuple(sound), design)
    for kind in sound:
        found = [
            torque_margin(chosen_rig, kind, joint, name, one, side)
            for one in loads
            for side, (joint, name) in enumerate(zip(kind.joints, kind.cylinders))
        ]
        worst = min(found, key=lambda item: item[0])
        by_joint[kind.name] = worst[0]
        if worst[0] < least[0]:
            least = worst
    violations = [value for kind, row in zip(kinds, geometry) for value in (*row, -by_joint[kind.name])]
    return Screened(tuple(violations), least[0], by_joint, least[1])


def chosen_bores(
    rig: Rig, space: Space, loads: tuple[JointLoads, ...], numbers: Mapping[str, float]
) -> dict[str, int]:
    """Return for each kind of joint the place in the catalogue that the variables ask for.

    That is so many sizes above the smallest bore that carries the loads; where none does, above the one with the largest margin.

    Args:
        rig: The owner's machine.
        space: What may be chosen.
        loads: What the joints must carry.
        numbers: The variables of the design.
    """
    out = {}
    gauge = float(numbers["supply"]) - rig.environment.pressure
    for kind in space.kinds:
        need = 0.0
        for one in loads:
            for joint in kind.joints:
                angle, _, torque = (column[:: len(one.angle) // _PHASES] for column in one.column(joint))
                _, arm = length_and_arm(space.attachment(kind, numbers), kind.across, angle)
                need = max(need, float(np.max(np.abs(torque) / np.maximum(np.abs(arm), 1e-4))))
        area = 0.9 * need / gauge  # no bore with less can hold it; friction and speed are the screening's to see
        allowed = space.bores(kind)
        first = next((i for i, at in enumerate(allowed) if np.pi / 4 * space.catalogue.cylinders[at].bore ** 2 >= area), len(allowed) - 1)
        best = (-np.inf, first)
        for rank in range(first, len(allowed)):
            bore = allowed[rank]
            left = screen(rig, (kind,), loads, space.design(numbers, {other.name: bore for other in space.kinds})).by_joint[kind.name]
            if left > best[0]:
                best = (left, rank)
            if left >= 0.0 or left <= -_MISSING:
                break
        out[kind.name] = allowed[min(best[1] + int(numbers[f"{kind.name}.above"]), len(allowed) - 1)]
    return out


def torque_margin(
    rig: Rig, kind: JointKind, joint: str, name: str, loads: JointLoads, side: int = 0
) -> tuple[float, Thinnest]:
    """Return the margin of one cylinder under one condition, and where it is thinnest."""
    every = len(loads.angle) // _PHASES
    rows = slice((side * every // 2) % every, None, every)
    found = along(rig, kind, joint, name, loads, rows)
    torque = loads.column(joint)[2]
    slack = np.minimum(found.slack(torque[rows]), found.still_slack(torque[rows]))
    thin = int(np.argmin(slack))
    return margin(slack, torque), Thinnest(joint, str(loads.condition), (rows.start + thin * every) / len(torque))


def along(rig: Rig, kind: JointKind, joint: str, name: str, loads: JointLoads, rows: slice = slice(None)) -> Capability:
    """Return what a cylinder of a fitted rig can do along a joint's loop, at some of its samples."""
    angle, speed, _ = (column[rows] for column in loads.column(joint))
    return at(rig, kind, name, angle, speed)


def at(rig: Rig, kind: JointKind, name: str, angle: NDArray[np.float64], speed: NDArray[np.float64]) -> Capability:
    """Return what a cylinder of a fitted rig can do at some angles [rad] and speeds [rad/s] of its joint, shape (n,) each."""
    cylinder = rig.cylinders[name]
    attachment = cylinder.attachment or kind.own
    length, arm = length_and_arm(attachment, kind.across, angle)
    record = assembly.cylinders(rig)[list(rig.cylinders).index(name)]
    return capability(assembly.world(rig)[0], record, arm, length, cylinder.retracted_length, speed)
