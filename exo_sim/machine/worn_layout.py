"""Whether a worn machine's model is laid out as walking needs it: which way joints turn, where it stands, what touches what."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from exo_sim.errors import ModelError
from exo_sim.machine.person import COORDINATES, SEGMENTS

#: How an axis may differ from the one asked for, as the cosine between them: 1 degree.
_ALIGNED = np.cos(np.radians(1.0))
#: How far the lowest point of a sole may lie from the floor when the machine stands upright [m].
_STANDING = 0.02
_AXES = {"torso_x": (1.0, 0.0, 0.0), "torso_z": (0.0, 0.0, 1.0)}
_HINGE = (0.0, -1.0, 0.0)


def check(model: mujoco.MjModel, path: Path) -> None:
    """Check a compiled model of a worn machine that has all its parts, as its file draws it: for a body height of 1.70 m, on level floor.

    Raises:
        ModelError: what is laid out otherwise, and how it has to be.
    """
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    _axes(model, data, path)
    _person(model, path)
    if model.body(model.geom("payload").bodyid[0]).name != "payload":
        raise ModelError(f'{path}: the geom "payload" belongs to the body "payload", which the rig and --payload give a mass; put it there')
    _height(model, data, path)
    _soles(model, data, path)


def _axes(model: mujoco.MjModel, data: mujoco.MjData, path: Path) -> None:
    for name in ("torso_x", "torso_z", *COORDINATES[2:]):
        joint = model.joint(name)
        slides = name in _AXES
        wanted = _AXES.get(name, _HINGE)
        kind = mujoco.mjtJoint.mjJNT_SLIDE if slides else mujoco.mjtJoint.mjJNT_HINGE
        if joint.type[0] != kind or float(data.xaxis[joint.id] @ wanted) < _ALIGNED:
            axis = " ".join(f"{value:g}" for value in wanted)
            says = "a slide" if slides else "a hinge (flexion of the hip, extension of the knee, dorsiflexion of the ankle positive)"
            raise ModelError(f'{path}: the joint "{name}" of a worn machine is {says} about the axis {axis} in space; turn it so')


def _person(model: mujoco.MjModel, path: Path) -> None:
    bodies = [model.body(f"person_{segment}").id for segment in SEGMENTS]
    for segment, body in zip(SEGMENTS, bodies):
        if model.body_mocapid[body] < 0:
            raise ModelError(f'{path}: the body "person_{segment}" follows recorded motion; write mocap="true" at it')
        first = int(model.body_geomadr[body])
        geoms = range(first, first + int(model.body_geomnum[body]))
        if any(model.geom_contype[geom] or model.geom_conaffinity[geom] for geom in geoms):
            raise ModelError(
                f'{path}: the body "person_{segment}" would push the machine out of itself, for straps are what joins the two; '
                'write contype="0" conaffinity="0" at its geoms'
            )
    order = [int(model.body_mocapid[body]) for body in bodies]
    if order != sorted(order):
        names = ", ".join(f"person_{segment}" for segment in SEGMENTS)
        raise ModelError(f"{path}: the person's bodies stand in the order {names}; order them so")


def _height(model: mujoco.MjModel, data: mujoco.MjData, path: Path) -> None:
    """The joint's own coordinate says how high the torso is: the reference motion is given in it."""
    torso, joint = model.body("torso").id, model.joint("torso_z")
    height, said = float(data.xpos[torso, 2]), float(model.qpos0[joint.qposadr[0]])
    if abs(height - said) > 1e-6:
        raise ModelError(
            f'{path}: the body "torso" stands at a height of {height:g} m, which its joint "torso_z" calls {said:g} m; '
            f'write ref="{height:g}" at the joint'
        )


def _soles(model: mujoco.MjModel, data: mujoco.MjData, path: Path) -> None:
    floor = model.geom("floor")
    if floor.type[0] != mujoco.mjtGeom.mjGEOM_PLANE:
        raise ModelError(f'{path}: the geom "floor" of a worn machine is a plane, for slopes turn it; write type="plane"')
    for name in (f"{part}_{side}" for side in "lr" for part in ("heel", "toe")):
        sole = model.geom(name)
        if sole.type[0] != mujoco.mjtGeom.mjGEOM_SPHERE:
            raise ModelError(f'{path}: the geom "{name}" of a worn machine\'s sole is a sphere; write type="sphere" at it')
        if not (sole.contype[0] & floor.conaffinity[0] or floor.contype[0] & sole.conaffinity[0]):
            raise ModelError(
                f'{path}: the geom "{name}" never touches the geom "floor"; write contype="1" at the one and conaffinity="1" at the other'
            )
        lowest = float(data.geom_xpos[sole.id, 2] - sole.size[0] - data.geom_xpos[floor.id, 2])
        if abs(lowest) > _STANDING:
            where = f"{abs(lowest) * 1e3:.0f} mm {'above' if lowest > 0 else 'below'}"
            raise ModelError(
                f'{path}: standing upright, the sole "{name}" is {where} the geom "floor" (20 mm at most); the file is drawn for a body '
                "height of 1.70 m: thigh 440 mm, shank 369 mm, ankle 70 mm above the floor (docs/your_machine.md)"
            )
