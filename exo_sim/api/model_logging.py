"""`exo.log_model`: any MuJoCo model into a rerun recording, usable by itself."""

from __future__ import annotations

from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from exo_sim.recording.rrd_scene import Drawing
from exo_sim.recording.scene import Scene, shapes_of_model

#: By stream, the drawing of each model that was logged into it.
_DRAWINGS: WeakKeyDictionary[Any, dict[int, tuple[Any, Drawing]]] = WeakKeyDictionary()


def log_model(model: Any, data: Any, stream: Any) -> None:
    """Log where the bodies of a MuJoCo model are now; the first call logs their shapes as well.

    Poses go on the timeline "time" at `data.time`, bodies that rest are logged once. Planes and height fields are not drawn.

    Args:
        model: `mujoco.MjModel`.
        data: `mujoco.MjData` after `mj_step` or `mj_forward`.
        stream: `rerun.RecordingStream`.
    """
    bodies, shapes = shapes_of_model(model)
    kept = _DRAWINGS.setdefault(stream, {})
    _, drawing = kept.setdefault(id(model), (model, Drawing(stream)))
    positions, quaternions = data.xpos[None].copy(), data.xquat[None].copy()
    drawing.add(Scene(times=np.array([data.time]), bodies=bodies, positions=positions, quaternions=quaternions, shapes=shapes))
