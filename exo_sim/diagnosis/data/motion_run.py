"""The balance of forces of one joint, or along one rod, in one recording: its terms, all behind the same smoothing filter.

    inertia - passive - drive - external + resistance = 0

in newtons, or newton metres at a turning joint; every array has shape (n,) unless said otherwise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Kinematics:
    """Motion at the place where friction acts: that of the piston where one cylinder drives the joint, else the joint's.

    Attributes:
        position, velocity: There.
        still: Below this speed the sign of the velocity is not known.
        velocity_noise: Standard deviation of the noise left in `velocity`.
    """

    position: Array
    velocity: Array
    still: float
    velocity_noise: float = 0.0


@dataclass(frozen=True)
class Inertia:
    """What mass and gravity ask by the MJCF; along a rod, where no mass enters, the measured force of the load cell.

    Attributes:
        force: Mass times acceleration, gravity and centrifugal forces.
        bias: The part of `force` that does not go with acceleration.
        tilt: Derivative of `bias` with respect to the position's zero [1/rad or 1/m].
        effective_mass: Mass that the piston feels [kg]; 0 where it plays no part.
        has_mass: Whether a mass enters the balance.
        carried: The part of `force` that a payload as heavy as all that moves would ask; None where a mass that is off is the whole of it.
        alone: Whether no other joint moves: then an inertia that is off is the joint's own.
        noise: Standard deviation that noise of the positions, differentiated twice, leaves in one smoothed sample of `force`.
    """

    force: Array
    bias: Array
    tilt: Array
    effective_mass: float
    has_mass: bool = True
    carried: Array | None = None
    alone: bool = False
    noise: float = 0.0


@dataclass(frozen=True)
class Passive:
    """What springs and dampers of the MJCF exert: `force` together, `damping` the damper alone, None where there is none.

    Where several cylinders drive the joint, `force` is also what the rig says that their pistons meet.
    """

    force: Array
    damping: Array | None = None


@dataclass(frozen=True)
class Drive:
    """The force of the cylinders, from measured pressures or a load cell.

    Attributes:
        force: At the joint.
        cylinder: The one cylinder whose piston feels the friction, or None.
        arm: Its lever dX/dq; 1 without one.
        gauge: Its pressures above the atmosphere, shape (n, 2); zero without one.
        levers: Derivative of `force` with respect to each column that it was made from [N/Pa, N m/Pa, ...].
        signals: Of those columns whose scale shows in the balance, what they measured, smoothed alike [Pa above the atmosphere, N ...].
    """

    force: Array
    cylinder: str | None
    arm: Array
    gauge: Array
    levers: Mapping[str, Array]
    signals: Mapping[str, Array] = field(default_factory=dict)

    @property
    def usual_arm(self) -> float:
        """Median size of the lever, by which a force at the joint is called one at the piston [m/rad, or 1]."""
        return max(float(np.median(np.abs(self.arm))), 1e-9)

    @property
    def divisor(self) -> Array:
        """The lever, by which something at the joint is divided to have it at the piston [m/rad, or 1]; 1 where it all but vanishes."""
        return np.where(np.abs(self.arm) > 1e-6, self.arm, 1.0)


@dataclass(frozen=True)
class Imputed:
    """What the drive owes to a pressure that nobody measured and that the gas model predicts instead.

    Attributes:
        uncertain: Response of the drive to one standard deviation of each number that the predicted pressure depends on.
        leaks: Response of the drive to each parameter of a leak from that chamber, per unit of it.
    """

    uncertain: Mapping[str, Array] = field(default_factory=dict)
    leaks: Mapping[str, Array] = field(default_factory=dict)


@dataclass(frozen=True)
class MotionRun:
    """The balance of forces in one recording.

    Attributes:
        recording, joint: Names; of a balance along a rod, the cylinder's in place of the joint's.
        turning: Whether the joint is a hinge.
        time: [s].
        breaks: Indices at which a new stretch begins.
        every: Of how many samples of the recording one was kept.
        kinematics, inertia, passive, drive: The terms.
        external: Measured generalised force from outside, of straps and the ground as well; zero where none was recorded.
        external_recorded: Whether it was.
        noise: Standard deviation that sensor noise leaves in one smoothed sample of the balance.
        imputed: Set where a pressure of the drive was not measured but predicted.
        known: Where all forces were recorded; None for everywhere. Elsewhere the balance is not judged.
        smoothing: Width of the filter that noise of the positions asks for [s]; 0 where the least of the clock will do.
    """

    recording: str
    joint: str
    turning: bool
    time: Array
    breaks: tuple[int, ...]
    kinematics: Kinematics
    inertia: Inertia
    passive: Passive
    drive: Drive
    external: Array
    noise: float
    external_recorded: bool = False
    every: int = 1
    imputed: Imputed | None = None
    known: NDArray[np.bool_] | None = None
    smoothing: float = 0.0

    @property
    def cylinder(self) -> str | None:
        """The one cylinder whose piston feels the friction, or None."""
        return self.drive.cylinder

    @property
    def demand(self) -> Array:
        """Force that the motion takes and the MJCF's own springs and dampers do not supply."""
        return self.inertia.force - self.passive.force

    @property
    def judged(self) -> NDArray[np.bool_]:
        """Samples at which all forces were recorded, shape (n,)."""
        return np.ones(len(self.time), dtype=bool) if self.known is None else self.known

    @property
    def driving(self) -> Array:
        """Force that drives the motion, where all of it was recorded, shape (judged,)."""
        return np.asarray((self.drive.force + self.external)[self.judged])

    @property
    def effort(self) -> float:
        """Size of the forces that act: standard deviation of those that drive the motion and of those that it takes."""
        return float(np.std(self.driving)) + float(np.std(self.inertia.force[self.judged]))

    def part(self, start: int, stop: int) -> MotionRun:
        """Return the samples from `start` to before `stop` as a run of their own; its arrays are views."""
        cut = slice(start, stop)

        def each(signals: Mapping[str, Array]) -> dict[str, Array]:
            return {name: values[cut] for name, values in signals.items()}

        path, inertia, passive, drive, imputed = self.kinematics, self.inertia, self.passive, self.drive, self.imputed
        return replace(
            self, time=self.time[cut], breaks=(0, *(b - start for b in self.breaks if start < b < stop)),
            kinematics=replace(path, position=path.position[cut], velocity=path.velocity[cut]),
            inertia=replace(
                inertia, force=inertia.force[cut], bias=inertia.bias[cut], tilt=inertia.tilt[cut],
                carried=None if inertia.carried is None else inertia.carried[cut],
            ),
            passive=Passive(passive.force[cut], None if passive.damping is None else passive.damping[cut]),
            drive=replace(
                drive, force=drive.force[cut], arm=drive.arm[cut], gauge=drive.gauge[cut],
                levers=each(drive.levers), signals=each(drive.signals),
            ),
            external=self.external[cut],
            imputed=None if imputed is None else Imputed(each(imputed.uncertain), each(imputed.leaks)),
            known=None if self.known is None else self.known[cut],
        )  # fmt: skip
