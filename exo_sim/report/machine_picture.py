"""A picture of a worn machine in motion: moments of a recording side by side, drawn by MuJoCo without a display."""

from __future__ import annotations

import copy
import ctypes
import os
import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from pathlib import Path

    import mujoco
    from matplotlib.figure import Figure

    from exo_sim.rig import Rig

Columns = Mapping[str, NDArray[np.float64]]

#: Metres between the moments in the picture.
SPACING = 0.95
#: Vertical field of view [deg], narrow so that the outer moments are not seen askew.
_VIEW = 14.0
#: Metres of arrow per newton of ground force.
_ARROW = 1.5 / 1000.0
_BARREL, _ROD, _GROUND = (0.42, 0.47, 0.55, 1.0), (0.93, 0.94, 0.96, 1.0), (0.10, 0.55, 0.25, 1.0)


class NoRenderer(RuntimeError):
    """This machine has nothing to draw with; a plot must do."""


def headless() -> None:
    """Have MuJoCo draw without a display where there is none. Heeded until the first import of mujoco."""
    if sys.platform == "linux" and "DISPLAY" not in os.environ:
        try:
            ctypes.CDLL("libEGL.so.1")
        except OSError:
            return
        os.environ.setdefault("MUJOCO_GL", "egl")


def stride(columns: Columns, count: int = 6) -> list[int]:
    """Return rows at even phases of the last whole cycle, or evenly spread where there is no gait phase."""
    phase = columns.get("gait.phase")
    n = len(next(iter(columns.values())))
    wraps = [] if phase is None else list(np.flatnonzero(np.diff(phase) < -0.5) + 1)
    first, last = (wraps[-2], wraps[-1]) if len(wraps) > 1 else (0, n - 1)
    return [int(row) for row in np.linspace(first, last, count, endpoint=False)]


def moments(
    model: mujoco.MjModel, rig: Rig, columns: Columns, rows: Sequence[int], size: tuple[int, int] = (1280, 480)
) -> NDArray[np.uint8]:
    """Draw the machine on its wearer at some rows of a recording, from left to right.

    Cylinders are drawn with their barrels and rods, as far out as they are; arrows are the ground's forces on the feet.

    Args:
        model: The model that was simulated.
        rig: Its cylinders.
        columns: `"<part>.<signal>"` to values; positions of all joints of the model are needed.
        rows: Which rows.
        size: Width and height in pixels.

    Returns:
        Red, green, blue, shape (height, width, 3).

    Raises:
        NoRenderer: no OpenGL without a display here; `libegl1 libgl1-mesa-dri` bring it on Debian.
    """
    headless()
    import mujoco

    width, height = size
    model = copy.copy(model)
    model.vis.global_.offwidth = max(model.vis.global_.offwidth, width)
    model.vis.global_.offheight = max(model.vis.global_.offheight, height)
    model.vis.global_.fovy = _VIEW
    data = mujoco.MjData(model)
    try:
        renderer = mujoco.Renderer(model, height, width, max_geom=2000)
    except Exception as error:
        raise NoRenderer(f"MuJoCo cannot draw without a display here: {error}") from error
    with renderer:
        for place, row in enumerate(rows):
            _pose(mujoco, model, data, columns, row, (place - (len(rows) - 1) / 2) * SPACING)
            if place == 0:
                renderer.update_scene(data, _camera(mujoco, len(rows), width / height), _options(mujoco))
            else:
                kinds = mujoco.mjtCatBit.mjCAT_DYNAMIC
                pert = mujoco.MjvPerturb()
                mujoco.mjv_addGeoms(model, data, _options(mujoco), pert, kinds, renderer.scene)
            _cylinders(mujoco, model, data, rig, renderer.scene)
            _ground_forces(mujoco, model, data, columns, row, renderer.scene)
        return np.array(renderer.render())


def sketch(model: mujoco.MjModel, columns: Columns, rows: Sequence[int]) -> Figure:
    """Plot the machine as sticks at some rows of a recording: what is left where nothing can draw solids."""
    import mujoco
    from matplotlib.figure import Figure

    data = mujoco.MjData(model)
    figure = Figure(figsize=(12.8, 4.8), layout="constrained")
    axes = figure.subplots()
    for place, row in enumerate(rows):
        _pose(mujoco, model, data, columns, row, place * SPACING)
        for body in range(1, model.nbody):
            if model.body_mocapid[body] < 0 and model.body_parentid[body] > 0:
                joined = data.xpos[[model.body_parentid[body], body]]
                color = "C1" if model.body(body).name.endswith("_l") else "C0"
                axes.plot(joined[:, 0], joined[:, 2], "o-", color=color)
        for tendon in range(model.ntendon):
            start, stop = (data.site_xpos[model.wrap_objid[model.tendon_adr[tendon] + i]] for i in range(2))
            axes.plot([start[0], stop[0]], [start[2], stop[2]], color="0.5", linewidth=3)
    axes.set_aspect("equal")
    axes.set_xlabel("moments of one stride, set apart [m]")
    axes.set_ylabel("height [m]")
    return figure


def save(path: Path, model: mujoco.MjModel, rig: Rig, columns: Columns) -> str:
    """Write one stride of a recording as a PNG: drawn where this machine can, else plotted.

    Returns:
        "drawing", or why it is a plot.

    Raises:
        OutputError: `path` cannot be written.
    """
    from exo_sim.outputs import replacing

    rows = stride(columns)
    try:
        pixels = moments(model, rig, columns, rows)
    except NoRenderer as reason:
        with replacing(path) as beside:
            sketch(model, columns, rows).savefig(beside, format="png", dpi=100)
        return str(reason)
    from matplotlib.image import imsave

    with replacing(path) as beside:
        imsave(beside, pixels, format="png")
    return "drawing"


def _pose(mujoco: Any, model: Any, data: Any, columns: Columns, row: int, x: float) -> None:
    """Put the machine as it was at a row, and the person's segments where the machine's are."""
    for joint in range(model.njnt):
        data.qpos[model.jnt_qposadr[joint]] = columns[f"{model.joint(joint).name}.position"][row]
    data.qpos[model.joint("torso_x").qposadr[0]] = x
    mujoco.mj_kinematics(model, data)
    for body in range(model.nbody):
        name = model.body(body).name
        if model.body_mocapid[body] >= 0 and name.startswith("person_"):
            worn = data.body(name.removeprefix("person_"))
            data.mocap_pos[model.body_mocapid[body]] = [worn.xpos[0], model.body_pos[body][1], worn.xpos[2]]
            data.mocap_quat[model.body_mocapid[body]] = worn.xquat
    mujoco.mj_forward(model, data)


def _options(mujoco: Any) -> Any:
    options = mujoco.MjvOption()
    options.flags[mujoco.mjtVisFlag.mjVIS_TENDON] = False  # drawn as cylinders instead
    return options


def _camera(mujoco: Any, count: int, aspect: float) -> Any:
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.lookat[:] = (0.0, 0.0, 0.86)
    camera.distance = max((count + 0.3) * SPACING / aspect, 1.95) / (2.0 * np.tan(np.deg2rad(_VIEW / 2)))
    camera.azimuth, camera.elevation = 96.0, -6.0
    return camera


def _cylinders(mujoco: Any, model: Any, data: Any, rig: Rig, scene: Any) -> None:
    for cylinder in rig.cylinders.values():
        transmission = model.actuator(cylinder.actuator)
        if transmission.trntype[0] != mujoco.mjtTrn.mjTRN_TENDON:
            continue
        start = model.tendon_adr[transmission.trnid[0]]
        base, rod_end = (data.site_xpos[model.wrap_objid[start + i]] for i in range(2))
        along = (rod_end - base) / np.linalg.norm(rod_end - base)
        barrel_end = base + along * min(cylinder.retracted_length * 0.9, float(np.linalg.norm(rod_end - base)))
        _connect(mujoco, scene, "CYLINDER", 0.55 * cylinder.bore, base, barrel_end, _BARREL)
        _connect(mujoco, scene, "CYLINDER", max(0.5 * cylinder.rod, 0.006), barrel_end, rod_end, _ROD)


def _ground_forces(mujoco: Any, model: Any, data: Any, columns: Columns, row: int, scene: Any) -> None:
    for site in range(model.nsite):
        name = model.site(site).name
        force = [columns.get(f"{name}.ground_force_{axis}") for axis in "xyz"]
        if force[2] is None or force[2][row] < 20.0:
            continue
        vector = np.array([0.0 if part is None else part[row] for part in force]) * _ARROW
        start = data.site_xpos[site] * (1.0, 2.4, 1.0)  # beside the foot, not hidden in the leg
        _connect(mujoco, scene, "ARROW", 0.022, start, start + vector, _GROUND)


def _connect(mujoco: Any, scene: Any, kind: str, radius: float, start: Any, stop: Any, rgba: Sequence[float]) -> None:
    """Add a geom between two points to the scene."""
    if scene.ngeom >= scene.maxgeom:
        return
    geom = scene.geoms[scene.ngeom]
    shape = getattr(mujoco.mjtGeom, f"mjGEOM_{kind}")
    mujoco.mjv_initGeom(geom, shape, np.zeros(3), np.zeros(3), np.eye(3).ravel(), np.array(rgba, dtype=np.float32))
    mujoco.mjv_connector(geom, shape, radius, np.asarray(start), np.asarray(stop))
    scene.ngeom += 1
