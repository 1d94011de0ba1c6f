"""The one table of signal names: what a column `<part>.<signal> [<unit>]` may be called, its SI unit, and its label."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Signal:
    """One kind of column.

    Attributes:
        name: The part of a column name behind the dot.
        part: What stands before the dot: "cylinder", "joint", "site", "supply", "exhaust", "recovery", "gait" or
            "ledger".
        units: SI units it may have; more than one where a joint slides or turns.
        label: Words for a plot.
        measured: True where a real recording may hold it; False for what only a simulation knows.
    """

    name: str
    part: str
    units: tuple[str, ...]
    label: str
    measured: bool = True


TABLE = (
    Signal("valve_command", "cylinder", ("1",), "valve command"),
    Signal("valve_command_1", "cylinder", ("1",), "valve command, chamber 1"),
    Signal("valve_command_2", "cylinder", ("1",), "valve command, chamber 2"),
    Signal("pressure_1", "cylinder", ("Pa",), "pressure, chamber 1"),
    Signal("pressure_2", "cylinder", ("Pa",), "pressure, chamber 2"),
    Signal("temperature_1", "cylinder", ("K",), "temperature, chamber 1"),
    Signal("temperature_2", "cylinder", ("K",), "temperature, chamber 2"),
    Signal("force", "cylinder", ("N",), "rod force, + pushes out"),
    Signal("position", "joint", ("m", "rad"), "joint position"),
    Signal("velocity", "joint", ("m/s", "rad/s"), "joint velocity"),
    Signal("external_force", "joint", ("N", "N*m"), "generalised force from outside"),
    Signal("pressure", "supply", ("Pa",), "supply pressure"),
    Signal("temperature", "supply", ("K",), "supply temperature"),
    Signal("pressure", "exhaust", ("Pa",), "exhaust pressure"),
    Signal("ground_force_x", "site", ("N",), "ground force, forward"),
    Signal("ground_force_y", "site", ("N",), "ground force, left"),
    Signal("ground_force_z", "site", ("N",), "ground force, up"),
    Signal("pressure_centre", "site", ("m",), "where the ground pushes, ahead of the site along its body's x axis"),
    Signal("strap_force_x", "site", ("N",), "strap force on the machine, forward"),
    Signal("strap_force_y", "site", ("N",), "strap force on the machine, left"),
    Signal("strap_force_z", "site", ("N",), "strap force on the machine, up"),
    Signal("force_demanded", "cylinder", ("N",), "rod force demanded", measured=False),
    Signal("length", "cylinder", ("m",), "piston position X", measured=False),
    Signal("choked", "cylinder", ("1",), "paths that are choked", measured=False),
    Signal("gas_used", "cylinder", ("kg",), "gas drawn from the supply", measured=False),
    Signal("torque", "joint", ("N", "N*m"), "torque of the actuators at the joint", measured=False),
    Signal("force_balance", "cylinder", ("N", "N*m"), "force that the motion took", measured=False),
    Signal("position_demanded", "joint", ("m", "rad"), "position demanded", measured=False),
    Signal("torque_demanded", "joint", ("N", "N*m"), "torque demanded at the joint", measured=False),
    Signal("wearer_moment", "joint", ("N", "N*m"), "extra moment that the straps impose on the wearer", measured=False),
    Signal("wearer_total_moment", "joint", ("N", "N*m"), "moment of the wearer, own body and straps", measured=False),
    Signal("wearer_power", "joint", ("W",), "power of the wearer's joint", measured=False),
    Signal("wearer_force_x", "site", ("N",), "ground force on the wearer, forward", measured=False),
    Signal("wearer_force_z", "site", ("N",), "ground force on the wearer, up", measured=False),
    Signal("wearer_pressure_centre", "site", ("m",), "centre of pressure ahead of the wearer's ankle", measured=False),
    Signal("ground_power", "ledger", ("W",), "power of the ground on the machine", measured=False),
    Signal("damping_power", "ledger", ("W",), "power of damping and friction of the machine's joints", measured=False),
    Signal("spring_power", "ledger", ("W",), "power of the machine's springs", measured=False),
    Signal("actuator_power", "ledger", ("W",), "power of cylinders and motors", measured=False),
    Signal("torso_strap_power", "ledger", ("W",), "power of the torso straps on the machine", measured=False),
    Signal("thigh_strap_power", "ledger", ("W",), "power of the thigh cuffs on the machine", measured=False),
    Signal("shoe_strap_power", "ledger", ("W",), "power of the shoes on the machine", measured=False),
    Signal("residual_force_x", "ledger", ("N",), "force that holds the wearer's pelvis, forward", measured=False),
    Signal("residual_force_z", "ledger", ("N",), "force that holds the wearer's pelvis, up", measured=False),
    Signal("residual_moment", "ledger", ("N*m",), "moment that holds the wearer's pelvis", measured=False),
    Signal("pressure", "recovery", ("Pa",), "pressure of the recovery tank", measured=False),
    Signal("gas", "recovery", ("kg",), "gas in the recovery tank", measured=False),
    Signal("phase", "gait", ("1",), "gait phase", measured=False),
    Signal("stance_l", "gait", ("1",), "left foot on the ground", measured=False),
    Signal("stance_r", "gait", ("1",), "right foot on the ground", measured=False),
)

#: Signals that command a valve: one spool, or each chamber's edges for themselves.
VALVE_COMMANDS = ("valve_command", "valve_command_1", "valve_command_2")

#: Parts of which there is only one, called by these names in every recording.
SHARED_PARTS = ("supply", "exhaust", "recovery", "gait", "ledger")


def find(part_kind: str, name: str) -> Signal | None:
    """Return the signal called `name` on a part of this kind, or None."""
    return next((signal for signal in TABLE if signal.part == part_kind and signal.name == name), None)


def names(part_kind: str) -> tuple[str, ...]:
    """Return the names of all signals that a part of this kind may have."""
    return tuple(signal.name for signal in TABLE if signal.part == part_kind)


def column(part: str, name: str) -> str:
    """Return the key of a column without its unit: `"piston.pressure_1"`."""
    return f"{part}.{name}"
