"""A rig in memory. Everything in SI; pressures absolute."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from exo_sim.errors import RigError

#: cp/cv of no gas is more: that of one atom is 5/3.
LARGEST_HEAT_CAPACITY_RATIO = 2.0
#: Nobody's room, and no supply, is as cold [K]: what is written with fewer is in degC.
COLDEST = 100.0
#: Of a supply, and of chambers that are filled [Pa].
LARGEST_PRESSURE = 1e9


@dataclass(frozen=True)
class Environment:
    """Around the machine: pressure [Pa] and temperature [K]."""

    pressure: float = 101325.0
    temperature: float = 293.15


@dataclass(frozen=True)
class Supply:
    """Upstream of every valve: pressure [Pa] and temperature [K]."""

    pressure: float
    temperature: float = 293.15


@dataclass(frozen=True)
class Recovery:
    """A tank between exhaust and supply that chambers give gas to and take it from.

    Attributes:
        volume: [m^3].
        pressure: At the start, and that which controllers keep it near, absolute [Pa].
    """

    volume: float
    pressure: float


@dataclass(frozen=True)
class Attachment:
    """Where a cylinder's ends hang, from the axis of the joint that it drives, x forward and z up with all joints at zero [m].

    Attributes:
        base: "from" in the file: (x, z) of the first end, on the tendon's first site.
        rod: "to" in the file: (x, z) of the rod's end, on the tendon's last site.
    """

    base: tuple[float, float]
    rod: tuple[float, float]


#: What a valve may be: one spool for both chambers, or edges that each chamber has for itself.
VALVE_KINDS = ("4-way", "independent")


@dataclass(frozen=True)
class Valve:
    """What a valve is besides the area of its paths; its edges and its flow law are effects of the cylinder (`of_valve`).

    Attributes:
        independent: Whether each chamber has a command of its own.
        sizes: Keys of the file that say how large its paths are, with their SI values and units.
    """

    independent: bool = False
    sizes: tuple[tuple[str, float, str], ...] = ()


@dataclass(frozen=True)
class Cylinder:
    """One cylinder with its valve; lengths in m, volumes in m^3, areas in m^2. `valve_area` is 0 where there is no valve, that of the
    largest path where paths differ. `attachment` is None where the MJCF's own points stand. `rating` is the largest pressure that it
    may see, absolute [Pa], or None."""

    name: str
    actuator: str
    bore: float
    rod: float
    stroke: float
    retracted_length: float
    dead_volume_1: float
    dead_volume_2: float
    single_acting: bool
    valve_area: float
    attachment: Attachment | None = None
    valve: Valve = Valve()
    rating: float | None = None

    @property
    def commands(self) -> tuple[str, ...]:
        """Names of the signals that command its valve."""
        return ("valve_command_1", "valve_command_2") if self.valve.independent else ("valve_command",)

    @property
    def needed_commands(self) -> tuple[str, ...]:
        """Those without which it is not known what the valve did: a chamber that is always open has nothing to command."""
        return self.commands[:1] if self.single_acting else self.commands

    @property
    def area_1(self) -> float:
        """Piston area on the side of chamber 1 [m^2]."""
        return math.pi / 4 * self.bore**2

    @property
    def area_2(self) -> float:
        """Piston area on the side of chamber 2, less the rod [m^2]."""
        return self.area_1 - math.pi / 4 * self.rod**2


@dataclass(frozen=True)
class EffectSetting:
    """One `[effects.NAME.WHERE]`.

    Attributes:
        name, where: As in the file.
        parameters: Single numbers, in SI.
        turning: True where they were given for a joint that turns (N m, rad), or for a column of one.
        curves: Parameters that are lists of numbers, in SI.
        of_valve: True where it says what `[cylinders.NAME.valve]` says, not what an `[effects]` table does.
    """

    name: str
    where: str
    parameters: Mapping[str, float]
    turning: bool = False
    curves: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    of_valve: bool = False


@dataclass(frozen=True)
class Wearer:
    """Who wears it: height [m] and mass [kg]."""

    height: float = 1.70
    mass: float = 75.0


@dataclass(frozen=True)
class Ankle:
    """The exoskeleton's ankle: "free", "sprung" with a stiffness [N m/rad], or "powered" with a largest torque [N m]."""

    mode: str = "sprung"
    stiffness: float = 100.0
    torque: float = 80.0


@dataclass(frozen=True)
class JointFactors:
    """What numbers that the MJCF says of a joint are multiplied with, and stops inside its own.

    Attributes:
        damping: On the joint's damping.
        inertia: On what the joint has to accelerate where the MJCF draws it; gravity stays as it is.
        range: Least and largest position [rad or m]; the MJCF's own where None.
    """

    damping: float = 1.0
    inertia: float = 1.0
    range: tuple[float, float] | None = None


@dataclass(frozen=True)
class Rig:
    """The nominal machine, as its owner describes it.

    Attributes:
        name: What it is called.
        model: The MJCF file.
        environment, supply: As in the file.
        specific_gas_constant: [J/(kg K)].
        heat_capacity_ratio: cp/cv.
        cylinders: By name, in the order of the file.
        effects: Physics beyond the paper.
        body_masses: Masses that replace the MJCF's, by body [kg].
        joint_factors: What numbers of the MJCF's joints are multiplied with, by joint.
        wearer, ankle: For machines that are worn.
        recovery: Its recovery tank, or None.
        text: The file as it stands.
        path: Where it was read from; errors name it.
    """

    name: str
    model: Path
    environment: Environment
    supply: Supply
    specific_gas_constant: float
    heat_capacity_ratio: float
    cylinders: Mapping[str, Cylinder]
    effects: tuple[EffectSetting, ...] = ()
    body_masses: Mapping[str, float] = field(default_factory=dict)
    joint_factors: Mapping[str, JointFactors] = field(default_factory=dict)
    wearer: Wearer = Wearer()
    ankle: Ankle = Ankle()
    text: str = ""
    path: Path = Path("rig.toml")
    recovery: Recovery | None = None

    def check_no_recovery(self, doing: str) -> None:
        """Refuse a recovery tank where nothing would move its paths.

        Raises:
            RigError: there is one.
        """
        if self.recovery is not None:
            raise RigError(
                f"{self.path}: [recovery] is moved by the plan of both pressures of a worn machine that walks; {doing} knows none: "
                "leave the table out"
            )

    def effect(self, name: str, where: str) -> EffectSetting | None:
        """Return the setting of an effect at a place, or None where it is off."""
        return next((effect for effect in self.effects if effect.name == name and effect.where == where), None)
