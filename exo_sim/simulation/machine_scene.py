"""A machine to draw: any model with its cylinders, at positions that were recorded or simulated."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.linkage import tendon_ends
from exo_sim.machine.rig_model import load
from exo_sim.recording.scene import DrawnCylinder, Scene, shapes_of_model
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

Array = NDArray[np.float64]

#: Frames a second in a scene, and how many there are at the most.
FRAME_RATE, MOST_FRAMES = 50.0, 10_000
_SCALAR = (int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE))
#: Diameter as which a rod is drawn at the least [m].
_THINNEST = 0.004


def machine_scene(model: mujoco.MjModel, rig: Rig, times: Array, qpos: Array) -> Scene:
    """Return bodies and cylinders of a machine.

    Args:
        model: The machine's.
        rig: Its cylinders.
        times: Of the frames [s], shape (n,).
        qpos: MuJoCo's positions at each, shape (n, nq).
    """
    data = mujoco.MjData(model)
    positions, quaternions = np.empty((len(times), model.nbody, 3)), np.empty((len(times), model.nbody, 4))
    sites = np.empty((len(times), model.nsite, 3))
    for i, row in enumerate(qpos):
        data.qpos[:] = row
        mujoco.mj_kinematics(model, data)
        positions[i], quaternions[i], sites[i] = data.xpos, data.xquat, data.site_xpos
    bodies, shapes = shapes_of_model(model)
    cylinders = []
    for name, cylinder in rig.cylinders.items():
        if (ends := tendon_ends(model, cylinder.actuator)) is not None:
            base, rod = sites[:, ends[0]], sites[:, ends[1]]
            cylinders.append(DrawnCylinder(name, base, rod, cylinder.retracted_length, cylinder.bore, max(cylinder.rod, _THINNEST)))
    return Scene(times, bodies, positions, quaternions, shapes, cylinders)


def recorded_scene(recording: Recording, rig: Rig) -> Scene | None:
    """Return a machine as its recorded positions have it, or None where no position of its joints was recorded.

    Joints that were not recorded stay where the model has them; gaps are passed over straight.

    Raises:
        ModelError, RigError: the rig's MJCF cannot be used.
    """
    model = load(rig)
    known = {}
    for j in range(model.njnt):
        values = recording.get(f"{model.joint(j).name}.position")
        if model.jnt_type[j] in _SCALAR and values is not None:
            known[int(model.jnt_qposadr[j])] = values
    if not known:
        return None
    span = float(recording.time[-1] - recording.time[0])
    count = min(max(2, round(span * FRAME_RATE) + 1), MOST_FRAMES, len(recording.time))
    times = np.linspace(recording.time[0], recording.time[-1], count)
    qpos = np.tile(model.qpos0, (count, 1))
    for address, values in known.items():
        good = np.isfinite(values)
        if good.any():
            qpos[:, address] = np.interp(times, recording.time[good], values[good])
    return machine_scene(model, rig, times, qpos)
