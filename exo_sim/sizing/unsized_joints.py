"""Cylinders that are not sized (`--joints`) still draw on the supply that is chosen: whether they carry their loads with it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.rig import Rig
from exo_sim.sizing.joint_kinds import JointKind, kinds_of
from exo_sim.sizing.loads import JointLoads
from exo_sim.sizing.screening import torque_margin


@dataclass(frozen=True)
class LeftAlone:
    """A kind of joint that stays as it is: torque in hand at a supply [Pa], as a share of its peak; negative where some is missing."""

    name: str
    supply: float
    margin: float

    @property
    def words(self) -> str:
        """Return it as a line of text."""
        if self.margin >= 0.0:
            return f"{self.name} stays as it is: its torque margin is {100 * self.margin:.0f} % of the peak at {self.supply / 1e5:.1f} bar."
        return (
            f"{self.name} stays as it is and is too weak at {self.supply / 1e5:.1f} bar: {-100 * self.margin:.0f} % of its peak torque is "
            f"missing. Size it as well (--joints), or allow more pressure."
        )


def kinds_left_alone(rig: Rig, kinds: tuple[JointKind, ...]) -> tuple[JointKind, ...]:
    """Return the groups of cylinders of a worn machine beside some that are sized; ankles only where they are asked for torque."""
    sized = {joint for kind in kinds for joint in kind.joints}
    joints = dict.fromkeys(link.joint for link in linkages(rig, load(rig)) if link.turning)
    others = tuple(
        joint for joint in joints if joint not in sized and (rig.ankle.mode == "powered" or not joint.startswith("ankle"))
    )
    return kinds_of(rig, others) if others else ()


def left_alone(rig: Rig, others: tuple[JointKind, ...], loads: tuple[JointLoads, ...], supply: float) -> tuple[LeftAlone, ...]:
    """Return what cylinders that stay as they are can do at a supply.

    Args:
        rig: The owner's machine.
        others: Their groups (`kinds_left_alone`).
        loads: What the joints must carry, by condition.
        supply: Absolute [Pa].
    """
    fed = replace(rig, supply=replace(rig.supply, pressure=supply))
    return tuple(
        LeftAlone(
            kind.name,
            supply,
            min(
                torque_margin(fed, kind, joint, name, one, side)[0]
                for one in loads
                for side, (joint, name) in enumerate(zip(kind.joints, kind.cylinders))
            ),
        )
        for kind in others
    )
