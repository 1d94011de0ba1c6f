"""What the rods of a machine that nobody wears must do along a recorded motion: force, travel, speed."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.control.tracking import Tracking, TrackingGains
from exo_sim.machine.rig_model import load
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig
from exo_sim.simulation.plugin import PneumaticPlugin
from exo_sim.simulation.wanted_motion import WantedMotion, wanted

Array = NDArray[np.float64]
#: Moments of a motion at which forces are worked out.
_MOMENTS = 400
#: Places in a joint's range at which the length of its cylinder is worked out.
_PLACES = 41
_BOUNDLESS = 1e9


@dataclass(frozen=True)
class RodLoads:
    """What the rods must do, columns in the order of the rig's cylinders, n moments.

    Attributes:
        motion: The whole motion.
        length: Of each transmission along it [m], shape (n, m).
        speed: Its rate [m/s], shape (n, m).
        force: On each rod, the least relative to what its cylinder holds [N], shape (n, m).
        span: Least and largest length over the motion and, where it is limited, the range of the joint [m], shape (m, 2).
    """

    motion: WantedMotion
    length: Array
    speed: Array
    force: Array
    span: Array


def rod_loads(rig: Rig, recording: Recording) -> RodLoads:
    """Return what the rods must do: inverse dynamics along the motion, forces from outside acting.

    Raises:
        ModelError, RigError: the machine cannot be built.
        RecordingError: the motion is none for this machine.
    """
    model = load(rig)
    plugin = PneumaticPlugin(model, rig)
    links, motion = plugin.links, wanted(recording, rig, model, plugin.links)
    dofs = np.array(sorted({link.dof for link in links}), dtype=np.int64)
    at = [motion.joints.index(model.joint(int(model.dof_jntid[dof])).name) for dof in dofs]
    actuators = np.array([link.actuator for link in links], dtype=np.int64)
    areas = plugin.pneumatics.cylinders
    share = np.stack([-_BOUNDLESS * areas["area_2"] / areas["area_1"].max(), _BOUNDLESS * areas["area_1"] / areas["area_1"].max()], axis=1)
    tracking = Tracking(model, dofs, actuators, share, TrackingGains())
    moments = np.unique(np.linspace(0, len(motion.time) - 1, _MOMENTS).astype(int))
    length, speed, force = (np.empty((len(moments), len(links))) for _ in range(3))
    data = mujoco.MjData(model)
    addresses = [(int(model.joint(name).qposadr[0]), int(model.joint(name).dofadr[0])) for name in motion.joints]
    for row, k in enumerate(moments):
        for j, (position, velocity) in enumerate(addresses):
            data.qpos[position], data.qvel[velocity] = motion.position[k, j], motion.velocity[k, j]
        data.qfrc_applied[:] = 0.0
        for name, values in motion.external.items():
            data.qfrc_applied[model.joint(name).dofadr[0]] += values[min(k, len(values) - 1)]
        mujoco.mj_step1(model, data)
        tracking.reset()
        needed = tracking.joint_force(data, motion.position[k, at], motion.velocity[k, at], motion.acceleration[k, at], 0.0)
        force[row] = tracking.rod_forces(data, needed)
        length[row], speed[row] = data.actuator_length[actuators], data.actuator_velocity[actuators]
    return RodLoads(motion, length, speed, force, _span(model, plugin, length))


def _span(model: mujoco.MjModel, plugin: PneumaticPlugin, length: Array) -> Array:
    span = np.stack([length.min(axis=0), length.max(axis=0)], axis=1)
    data = mujoco.MjData(model)
    for i, link in enumerate(plugin.links):
        joint = int(model.dof_jntid[link.dof])
        if not model.jnt_limited[joint]:
            continue
        low, high = (float(end) for end in model.jnt_range[joint])
        for place in np.linspace(low, high, _PLACES):
            data.qpos[:] = model.qpos0
            data.qpos[model.jnt_qposadr[joint]] = place
            mujoco.mj_fwdPosition(model, data)
            here = float(data.actuator_length[link.actuator])
            span[i] = min(span[i, 0], here), max(span[i, 1], here)
    return span
