"""What each joint must carry along a scenario: the machine's own inverse dynamics with no moment on the torso straps.

Human moments scaled by mass would put the load at the body's mass centre and so underestimate hip and knee; they stand beside the
loads for sense only.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.control import machine_dynamics
from exo_sim.control.demand import demand
from exo_sim.errors import ScenarioError
from exo_sim.gait import recorded_gait
from exo_sim.gait import scenario as scenarios
from exo_sim.gait.motion import phases
from exo_sim.gait.residual_reduction import worn
from exo_sim.machine.linkage import linkages
from exo_sim.machine.person import COORDINATES, Person
from exo_sim.machine.straps import fasten
from exo_sim.machine.worn_model import PAYLOAD_LIMIT, build, carry
from exo_sim.rig import Ankle, Rig, Wearer

JOINTS = COORDINATES[3:]
#: The law that says what the joints must carry.
LAW = "inverse_dynamics"
_EVERYTHING = 1e9


@dataclass(frozen=True)
class Condition:
    """One thing that the machine must be strong enough for.

    Attributes:
        scenario: Its name.
        payload: On the back [kg].
        speed: Factor on the recorded cadence.
        height: Of the wearer [m], with the mass of the rig's at the same build; the rig's own when None.
    """

    scenario: str
    payload: float
    speed: float = 1.0
    height: float | None = None

    def __str__(self) -> str:
        wearer = "" if self.height is None else f", wearer {self.height:.2f} m"
        return f"{self.scenario}, {self.payload:g} kg, cadence x {self.speed:g}{wearer}"

    def worn(self, rig: Rig) -> Rig:
        """Return the rig on this wearer: mass goes with the height's square, the body mass index stays."""
        if self.height is None:
            return rig
        mass = rig.wearer.mass * (self.height / rig.wearer.height) ** 2
        return replace(rig, wearer=Wearer(self.height, mass))


@dataclass(frozen=True)
class JointLoads:
    """Torque against angle and speed over one cycle, columns as `JOINTS`, n = SAMPLES rows at even phases.

    Attributes:
        condition: What it is for; payload with whatever the scenario adds.
        period: Of a cycle [s].
        angle: [rad], shape (n, 6).
        speed: [rad/s], shape (n, 6).
        torque: That the machine's actuators must give [N m], shape (n, 6); the ankles' too, whoever gives it.
        human: Recorded moments of the wearer without machine [N m], shape (n, 6), or None where none were recorded.
        human_scaled: The same, scaled by the mass of frame and payload over the recorded person's.
        mass: Of frame and payload [kg].
    """

    condition: Condition
    period: float
    angle: NDArray[np.float64]
    speed: NDArray[np.float64]
    torque: NDArray[np.float64]
    human: NDArray[np.float64] | None
    human_scaled: NDArray[np.float64] | None
    mass: float

    def column(self, joint: str) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return angle, speed and torque of one joint, each of shape (n,)."""
        at = JOINTS.index(joint)
        return self.angle[:, at], self.speed[:, at], self.torque[:, at]


def joint_loads(rig: Rig, condition: Condition) -> JointLoads:
    """Return what the joints of a worn machine must carry.

    Args:
        rig: The machine; its frame, wearer and ankle count, its cylinders do not.
        condition: Scenario, payload, cadence, wearer. A scenario that adds load is sized for all of it.

    Raises:
        ModelError, ScenarioError: not a worn machine, no such scenario, a payload the frame cannot carry.
    """
    scenario, rig = scenarios.find(condition.scenario), condition.worn(rig)
    if scenario.added is not None:
        condition = replace(condition, payload=condition.payload + scenario.added.mass)
    person = Person(rig.wearer.height, rig.wearer.mass)
    model = build(rig.model, person, min(condition.payload, PAYLOAD_LIMIT), rig.ankle, rig.body_masses, rig.joint_factors)
    if condition.payload > PAYLOAD_LIMIT:
        if scenario.added is None:
            raise ScenarioError(f"payload {condition.payload:g} kg: the frame carries 0 to {PAYLOAD_LIMIT:g} kg")
        carry(model, condition.payload)
    motion = worn(scenarios.motion(condition.scenario, person, condition.speed), person, model)
    straps = fasten(model, person)
    dynamics = machine_dynamics.along(model, motion, person, straps)
    # an ankle without bounds: what it needs, too, is part of the picture; hip and knee do not depend on it
    torque = demand(LAW, dynamics, motion, straps, Ankle("powered", 0.0, _EVERYTHING))
    for joint in {link.joint for link in linkages(rig, model)} & {"ankle_l", "ankle_r"}:  # asked of a cylinder no more than the rig says
        at = JOINTS.index(joint)
        torque[:, at] = np.clip(torque[:, at], -rig.ankle.torque, rig.ankle.torque)
    if not np.isfinite(torque).all():
        raise ScenarioError(f"{condition}: inverse dynamics has no solution; the machine cannot do this")
    human = _human(scenario.gait, dynamics.mass)
    return JointLoads(
        condition=condition,
        period=motion.period,
        angle=motion.position[:, 3:9],
        speed=motion.slope[:, 3:9] / motion.period,
        torque=torque,
        human=None if human is None else human[0],
        human_scaled=None if human is None else human[1],
        mass=dynamics.mass,
    )


def _human(gait: str | None, mass: float) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Return recorded moments in the order of `JOINTS`, as they are and scaled by mass, shape (n, 6) each."""
    if gait is None:
        return None
    found = recorded_gait.load(gait)
    right = phases()
    columns = [found.moment[name](phase) for phase in ((right + 0.5) % 1.0, right) for name in ("hip", "knee", "ankle")]
    moments = np.stack(columns, axis=1)
    return moments, moments * (mass / found.mass)
