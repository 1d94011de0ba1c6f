"""`exo.log_model`: any MuJoCo model into a rerun recording, usable by itself."""

from __future__ import annotations

from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from exo_sim.errors import OutputError
from exo_sim.recording.rrd_scene import Drawing
from exo_sim.recording.scene import Scene, shapes_of_model

#: By stream, the drawing of each model that was logged into it.
_DRAWINGS: WeakKeyDictionary[Any, dict[int, tuple[Any, Drawing]]] = WeakKeyDictionary()


#: By its identifier, the stream that was in use when none was handed in: rerun hands out another object each time.
_IN_USE: dict[str, Any] = {}


def log_model(model: Any, data: Any, stream: Any = None) -> None:
    """Log where the bodies of a MuJoCo model are now; the first call logs their shapes as well.

    Poses go on the timeline "time" at `data.time`, bodies that rest are logged once. Planes and height fields are not drawn.

    Args:
        model: `mujoco.MjModel`.
        data: `mujoco.MjData` after `mj_step` or `mj_forward`.
        stream: `rerun.RecordingStream`; the recording in use (`rerun.init`, `with stream`) when None.

    Raises:
        OutputError: no stream was handed in, and no recording is in use.
    """
    stream = _in_use() if stream is None else stream
    bodies, shapes = shapes_of_model(model)
    kept = _DRAWINGS.setdefault(stream, {})
    _, drawing = kept.setdefault(id(model), (model, Drawing(stream)))
    positions, quaternions = data.xpos[None].copy(), data.xquat[None].copy()
    drawing.add(Scene(times=np.array([data.time]), bodies=bodies, positions=positions, quaternions=quaternions, shapes=shapes))


def _in_use() -> Any:
    import rerun

    found = rerun.get_data_recording()
    if found is None:
        raise OutputError('log_model: no recording is in use: call rerun.init("mine") before it, or hand in a stream')
    return _IN_USE.setdefault(found.get_recording_id(), found)
