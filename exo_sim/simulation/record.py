"""From a simulated walk to what is written: one table of signals, and the scene to draw."""

from __future__ import annotations

import mujoco
import numba
import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.linkage import tendon_ends
from exo_sim.machine.person import SEGMENTS, pose_bodies
from exo_sim.recording.scene import Arrows, DrawnCylinder, Scene, shapes_of_model
from exo_sim.recording.table import Recording
from exo_sim.simulation import wearer_log
from exo_sim.simulation.sensors import observe
from exo_sim.simulation.walk import JOINTS, Walk
from exo_sim.simulation.wearer_load import Wearing, wearing
from exo_sim.version import VERSION

#: Frames a second in the scene.
FRAME_RATE = 50.0
_STRAP_COLOUR = (0.90, 0.35, 0.40, 1.0)


def recording(walk: Walk, name: str, seed: int = 0) -> Recording:
    """Return a walk as a table with the contract's columns and what only a simulation knows, as the rig's sensors show it.

    Args:
        walk: What was simulated.
        name: What to call it.
        seed: Travels with it; a walk has no chance in it.
    """
    return observe(as_it_was(walk, name, seed), walk.rig)


def as_it_was(walk: Walk, name: str, seed: int = 0, wearer: Wearing | None = None) -> Recording:
    """Return the same as it was, before any sensor; `wearer` where what he gives is known."""
    columns, units = dict(walk.columns), dict(walk.units)
    if walk.moved is None:  # one who is a body is among the columns already
        placed, of_places = wearer_log.places(walk.poses)
        columns |= {key: np.ascontiguousarray(values) for key, values in placed.items()}
        units |= of_places
    worn = wearer if wearer is not None else wearing(walk)
    it = worn.machine
    for joint, values in zip(JOINTS, (it.moments - worn.body.moments).T):
        columns[f"{joint}.wearer_moment"], units[f"{joint}.wearer_moment"] = np.ascontiguousarray(values), "N*m"
    for signal, unit, table in (("wearer_total_moment", "N*m", it.moments), ("wearer_power", "W", it.powers)):
        for joint, values in zip(JOINTS, table.T):
            columns[f"{joint}.{signal}"], units[f"{joint}.{signal}"] = np.ascontiguousarray(values), unit
    for foot, side in enumerate("lr"):
        for signal, unit, values in (
            ("wearer_force_x", "N", it.ground.force[:, foot, 0]), ("wearer_force_z", "N", it.ground.force[:, foot, 1]),
            ("wearer_pressure_centre", "m", it.ground.centre[:, foot]),
        ):  # fmt: skip
            columns[f"foot_{side}.{signal}"], units[f"foot_{side}.{signal}"] = np.ascontiguousarray(values), unit
    for k, (signal, unit) in enumerate((("residual_force_x", "N"), ("residual_force_z", "N"), ("residual_moment", "N*m"))):
        columns[f"ledger.{signal}"], units[f"ledger.{signal}"] = np.ascontiguousarray(it.ground.residual[:, k]), unit
    request = walk.request
    notes = {
        "scenario": request.scenario,
        "payload": f"{request.payload:g} kg",
        "speed": request.speed if isinstance(request.speed, str) else f"{request.speed:g}",
        "assist": request.assist,
        "controller": request.controller,
        "demand": request.law,
        "rig": walk.rig.text,
        "seed": str(seed),
        "exo-sim": VERSION,
        **{module.__name__: module.__version__ for module in (mujoco, np, numba)},
    }
    return Recording(name, walk.time, columns, units, notes)


def scene(walk: Walk) -> Scene:
    """Return bodies, cylinders and ground forces at `FRAME_RATE`; the frames of a run's pieces are those of the run."""
    model = walk.model
    every = max(1, round(1.0 / (FRAME_RATE * walk.step)))
    rows = np.arange(-walk.first % every, len(walk.time), every)
    data = mujoco.MjData(model)
    columns = walk.columns
    qpos = np.stack([columns[f"{model.joint(i).name}.position"][rows] for i in range(model.njnt)], axis=1)
    offset_y = np.array([model.body(f"person_{segment}").pos[1] for segment in SEGMENTS])
    ends = {name: tendon_ends(model, cylinder.actuator) for name, cylinder in walk.rig.cylinders.items()}
    feet = [model.site(f"foot_{side}").id for side in "lr"]
    harness = [model.site(name).id for name in walk.straps.names]
    positions = np.empty((len(rows), model.nbody, 3))
    quaternions = np.empty((len(rows), model.nbody, 4))
    sites = np.empty((len(rows), model.nsite, 3))
    for i, row in enumerate(rows):
        data.qpos[:] = qpos[i]
        if walk.moved is None:
            pose_bodies(walk.poses[row], offset_y, data.mocap_pos, data.mocap_quat)
        mujoco.mj_kinematics(model, data)
        positions[i], quaternions[i], sites[i] = data.xpos, data.xquat, data.site_xpos
    bodies, shapes = shapes_of_model(model)
    cylinders = [
        DrawnCylinder(
            name=name,
            cap=sites[:, base],
            end=sites[:, rod],
            barrel_length=walk.rig.cylinders[name].retracted_length,
            bore=walk.rig.cylinders[name].bore,
            rod=max(walk.rig.cylinders[name].rod, 0.004),
        )
        for name, found in ends.items()
        if found is not None
        for base, rod in [found]
    ]
    arrows = [
        Arrows(f"ground force, {word} foot", sites[:, foot], _vectors(columns, f"foot_{side}.ground_force", rows))
        for foot, side, word in zip(feet, "lr", ("left", "right"))
    ]
    arrows += [
        Arrows(name, sites[:, site], _vectors(columns, f"{name}.strap_force", rows), rgba=_STRAP_COLOUR)
        for name, site in zip(walk.straps.names, harness)
    ]
    return Scene(
        times=walk.time[rows],
        bodies=bodies,
        positions=positions,
        quaternions=quaternions,
        shapes=shapes,
        cylinders=cylinders,
        arrows=arrows,
        follow="torso",
    )


def _vectors(columns: dict[str, NDArray[np.float64]], key: str, rows: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return x, 0, z of a force at some rows, shape (n, 3)."""
    return np.stack([columns[f"{key}_x"][rows], np.zeros(len(rows)), columns[f"{key}_z"][rows]], axis=1)
