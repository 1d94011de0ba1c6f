"""What a torque-driven wearer leaves in the log, and what it says of his joints, soles and residual."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.ground_reaction import FEET, TOES, Ground, under_foot
from exo_sim.machine.person import Person, poses_along
from exo_sim.machine.sole_contact import RADIUS
from exo_sim.machine.wearer_body import JOINTS
from exo_sim.simulation.wearer_inverse_dynamics import Held

Array = NDArray[np.float64]
Value = TypeVar("Value")

#: Columns of where he is: pelvis, trunk, and hip, knee and ankle of both legs.
PLACES = tuple(f"{name}.position" for name in JOINTS[:9])
#: A foot that carries less has no centre of pressure [N].
_LOADED = 5.0
#: A centre of pressure this far beyond the ends of the soles is outside: what touches is round [m].
_ROUND = RADIUS + 1e-3


def layout() -> list[tuple[str, str]]:
    """Return key and unit of every number that is logged of the wearer, in its order."""
    units = ["m", "m", *["rad"] * 9]
    out = [(f"{name}.position", unit) for name, unit in zip(JOINTS, units)]
    out += [(f"{name}.velocity", f"{unit}/s") for name, unit in zip(JOINTS, units)]
    out += [(f"{name}.torque", "N" if unit == "m" else "N*m") for name, unit in zip(JOINTS, units)]
    out += [(f"wearer_foot_{side}.{signal}", unit) for side in "lr"
            for signal, unit in (("force_x", "N"), ("force_z", "N"), ("place_x", "m"), ("place_z", "m"))]  # fmt: skip
    return [*out, ("wearer_ground.power", "W")]


def shown(named: Mapping[str, Value]) -> dict[str, Value]:
    """Return columns, or their units, without those of the log that `Moved` holds: where he is stays."""
    gone = {key for key, _ in layout() if not key.endswith((".position", ".velocity"))}
    return {key: value for key, value in named.items() if key not in gone}


def places(poses: Array) -> tuple[dict[str, Array], dict[str, str]]:
    """Return where a wearer is whose segments are known, as the columns that `layout` has of one who is a body, and their units.

    Args:
        poses: Of the segments, shape (n, 7, 6).
    """
    angle = poses[:, :, 2]
    joints = [angle[:, row] - angle[:, 0 if row in (1, 4) else row - 1] for row in range(1, 7)]
    return dict(zip(PLACES, [poses[:, 0, 0], poses[:, 0, 1], angle[:, 0], *joints])), dict(zip(PLACES, ["m", "m", *["rad"] * 7]))


@dataclass(frozen=True)
class Moved(Held):
    """A wearer who is a body, along some rows: what moved him, and what he stood on.

    Rates, also those of the poses, are means over the step that follows each row.

    Attributes:
        toes: Power of the moments at the toes, their springs' among them as those of tissues are at every joint [W], shape (n, 2).
        yielded: Power of the ground on the soles [W], shape (n,).
    """

    toes: Array
    yielded: Array

    def at(self, rows: NDArray[np.int64] | slice) -> Moved:
        """Return some rows of it."""
        ground = Ground(*(getattr(self.ground, each.name)[rows] for each in fields(Ground)))
        others = (getattr(self, each.name)[rows] for each in fields(self) if each.name not in ("poses", "wrench", "ground"))
        return Moved(self.poses[rows], self.wrench[rows], ground, *others)

    @property
    def sole_powers(self) -> Array:
        """What the foot below each ankle gives [W], shape (n, 2): the toes; soles and ground that yield are `yielded`."""
        return self.toes


def moved(columns: dict[str, Array], wrench: Array, person: Person) -> Moved:
    """Return what the log of a wearer says.

    Args:
        columns: As in `layout`, shape (n,) each.
        wrench: Of straps or pack on the segments, shape (n, 7, 3).
        person: Who it is.
    """
    position, rate, torque = (
        np.stack([columns[f"{name}.{signal}"] for name in JOINTS], axis=1) for signal in ("position", "velocity", "torque")
    )
    mean = rate.copy()
    mean[:-1] = 0.5 * (rate[:-1] + rate[1:])
    poses = poses_along(position[:, :9], mean[:, :9], person)
    pelvis = poses[:, :1, :2]
    force = np.stack([np.stack([columns[f"wearer_foot_{s}.force_{axis}"] for axis in "xz"], axis=1) for s in "lr"], axis=1)
    place = np.stack([np.stack([columns[f"wearer_foot_{s}.place_{axis}"] for axis in "xz"], axis=1) for s in "lr"], axis=1) - pelvis
    loaded = force[:, :, 1] > _LOADED
    angle = poses[:, FEET, 2]
    from_ankle = place - (poses[:, FEET, :2] - pelvis)
    centre = np.where(loaded, from_ankle[:, :, 0] * np.cos(angle) + from_ankle[:, :, 1] * np.sin(angle), 0.0)
    place = np.where(loaded[:, :, None], place, under_foot(poses, centre, person.ankle_height))
    tip = person.toe + TOES * person.scale
    outside = np.asarray(np.any(loaded & ((centre < person.heel - _ROUND) | (centre > tip + _ROUND)), axis=1), dtype=np.bool_)
    residual = torque[:, :3]
    ground = Ground(force, centre, place, np.zeros_like(residual), residual, outside)
    return Moved(
        poses, wrench, ground, torque[:, 3:9], mean[:, 3:9], torque[:, 9:] * mean[:, 9:],
        columns["wearer_ground.power"],
    )  # fmt: skip
