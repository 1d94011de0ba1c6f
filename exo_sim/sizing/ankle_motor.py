"""What the motors of driven ankles must give where no cylinder is there; they are bought by these numbers, not searched for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.rig import Rig
from exo_sim.sizing.force_bandwidth import NEEDED, needed
from exo_sim.sizing.loads import JointLoads

_ANKLES = ("ankle_l", "ankle_r")


@dataclass(frozen=True)
class MotorDemand:
    """One ankle's motor with its gear, at the joint: each number that of the condition which asks most.

    Attributes:
        joint: The harder of the two.
        asked: Largest torque of the inverse dynamics [N m]; more than `torque` where the rig's limit cuts it.
        torque: Largest torque within the rig's limit (`[ankle] torque`) [N m], by which the rest is worked out.
        rms: Of that torque over a cycle [N m], what a motor's heat goes by.
        speed: Fastest turn of the joint [rad/s].
        power: Largest mechanical power given [W].
        given: Mean of the power given [W].
        taken: Mean of the power taken back [W], positive.
        needed: Frequency below which `NEEDED` of the torque's power about its mean lies [Hz].
    """

    joint: str
    asked: float
    torque: float
    rms: float
    speed: float
    power: float
    given: float
    taken: float
    needed: float

    @property
    def words(self) -> str:
        """Return it as a line of text."""
        cut = f" (limit of the rig; {self.asked:.0f} would carry everything)" if self.asked > self.torque * (1 + 1e-9) else ""
        return (
            f"ankle motor, one a side, not searched for: {self.torque:.0f} N m{cut}, {self.rms:.0f} N m rms, {self.speed:.1f} rad/s, "
            f"{self.power:.0f} W at most; gives {self.given:.0f} W and takes back {self.taken:.0f} W in the mean; "
            f"{100 * NEEDED:.0f} % of its torque's power lies below {self.needed:.1f} Hz; its mass is the MJCF's"
        )


def ankle_motor(rig: Rig, loads: tuple[JointLoads, ...]) -> MotorDemand | None:
    """Return what the motor of a driven ankle must give, or None where a cylinder, a spring or nothing is there.

    Args:
        rig: The machine.
        loads: What its joints must carry, by condition.
    """
    if rig.ankle.mode != "powered":
        return None
    at_cylinders = {link.joint for link in linkages(rig, load(rig))}
    found = [_demand(rig.ankle.torque, one, joint) for one in loads for joint in _ANKLES if joint not in at_cylinders]
    if not found:
        return None
    hardest = max(found, key=lambda one: one.rms)
    return MotorDemand(hardest.joint, *(max(getattr(one, name) for one in found) for name in _NUMBERS))


_NUMBERS = tuple(name for name in MotorDemand.__dataclass_fields__ if name != "joint")


def _demand(most: float, loads: JointLoads, joint: str) -> MotorDemand:
    _, speed, asked = loads.column(joint)
    torque = np.clip(asked, -most, most)
    power = torque * speed
    return MotorDemand(
        joint=joint,
        asked=float(np.abs(asked).max()),
        torque=float(np.abs(torque).max()),
        rms=float(np.sqrt(np.mean(torque**2))),
        speed=float(np.abs(speed).max()),
        power=float(max(power.max(), 0.0)),
        given=float(np.maximum(power, 0.0).mean()),
        taken=float(np.maximum(-power, 0.0).mean()),
        needed=needed(torque, loads.period / len(torque)),
    )
