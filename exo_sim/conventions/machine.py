"""What a rig says of the columns of its recordings: which pressures there are, and where the pistons must be."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.conventions.gas_balance import CylinderColumns, stretches
from exo_sim.machine.linkage import Linkage, linkages
from exo_sim.recording import noise
from exo_sim.recording.table import Recording
from exo_sim.rig import Cylinder, Rig

Array = NDArray[np.float64]

_TABLE = 513


@dataclass(frozen=True)
class Machine:
    """A rig with its model and how its cylinders hang in it."""

    rig: Rig
    model: mujoco.MjModel
    links: tuple[Linkage, ...]

    @classmethod
    def of(cls, rig: Rig, model: mujoco.MjModel) -> Machine:
        return cls(rig, model, linkages(rig, model))

    @property
    def atmosphere(self) -> float:
        """Around the machine [Pa]."""
        return self.rig.environment.pressure

    @property
    def supply(self) -> float | None:
        """Upstream of every valve [Pa]; None where no valve could let it in."""
        return self.rig.supply.pressure if any(one.valve_area > 0.0 for one in self.rig.cylinders.values()) else None

    def cylinder(self, link: Linkage) -> Cylinder:
        """Return the cylinder of a linkage."""
        return self.rig.cylinders[link.cylinder]

    def joint_range(self, link: Linkage) -> tuple[float, float] | None:
        """Return least and greatest coordinate of the joint that a cylinder drives, where they are known."""
        joint = int(self.model.dof_jntid[link.dof])
        if not self.model.jnt_limited[joint]:
            return None
        low, high = self.model.jnt_range[joint]
        return float(low), float(high)

    def piston(self, link: Linkage, position: Array) -> Array:
        """Return the piston's X for coordinates of the joint that it drives, shape (n,), the other joints as the model draws them."""
        retracted = self.cylinder(link).retracted_length
        if self.model.actuator_trntype[link.actuator] == int(mujoco.mjtTrn.mjTRN_JOINT):
            return float(self.model.actuator_gear[link.actuator, 0]) * position - retracted
        finite = position[np.isfinite(position)]
        if not len(finite):
            return np.full_like(position, np.nan)
        data = mujoco.MjData(self.model)
        address = int(self.model.jnt_qposadr[self.model.dof_jntid[link.dof]])
        places = np.linspace(finite.min() - 1e-6, finite.max() + 1e-6, _TABLE)
        lengths = np.empty(_TABLE)
        for i, place in enumerate(places):
            data.qpos[:] = self.model.qpos0
            data.qpos[address] = place
            mujoco.mj_kinematics(self.model, data)
            mujoco.mj_comPos(self.model, data)
            mujoco.mj_tendon(self.model, data)
            mujoco.mj_transmission(self.model, data)
            lengths[i] = data.actuator_length[link.actuator]
        return np.asarray(np.interp(position, places, lengths)) - retracted


def chamber_columns(recording: Recording, machine: Machine) -> tuple[str, ...]:
    """Return the columns that hold pressures of chambers."""
    keys = [f"{name}.pressure_{side}" for name in machine.rig.cylinders for side in (1, 2)]
    return tuple(key for key in keys if key in recording)


def columns_of(recording: Recording, machine: Machine, link: Linkage) -> CylinderColumns | None:
    """Return what a recording says of a cylinder; None where its position or all its pressures are missing."""
    name = link.cylinder
    position = recording.get(f"{link.joint}.position")
    if position is None or not any(f"{name}.pressure_{side}" in recording for side in (1, 2)):
        return None
    columns = [recording.get(f"{name}.{command}") for command in machine.rig.cylinders[name].commands]
    commands = [np.zeros(len(recording.time)) if values is None else values for values in columns]
    rows, breaks = stretches(recording.time, [np.isfinite(position), *(np.isfinite(values) for values in commands)], recording.breaks)
    if not len(rows):
        return None

    def at(key: str, otherwise: float) -> Array:
        values = recording.get(key)
        return np.full(len(rows), otherwise) if values is None else np.where(np.isfinite(values[rows]), values[rows], otherwise)

    missing = np.full(len(recording.time), np.nan)
    pressures = [recording.columns.get(f"{name}.pressure_{side}", missing) for side in (1, 2)]
    noises = [noise.floor(values, recording.time).std if np.isfinite(values).any() else 0.0 for values in pressures]
    return CylinderColumns(
        recording.time[rows],
        breaks,
        np.stack([values[rows] for values in pressures]),
        machine.piston(link, position[rows]),
        commands[0][rows],
        at("supply.pressure", machine.rig.supply.pressure),
        at("exhaust.pressure", machine.atmosphere),
        (noises[0], noises[1]),
        commands[1][rows] if len(commands) > 1 else None,
    )
