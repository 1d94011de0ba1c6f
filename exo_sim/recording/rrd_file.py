"""Writing an .rrd: signals, scene, lanes and blueprint in one file that opens in the rerun viewer.

Of a signal that mostly keeps its value only the turns are written: a line through them is the signal. What a reader of the file gets
back is the same for the same recording. The bytes are not: rerun stamps every chunk and every view of the blueprint with an identifier
from clock and chance. The table beside it (`write_table`) is the same byte for byte.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.outputs import replacing
from exo_sim.recording import blueprint
from exo_sim.recording.rrd_sink import written
from exo_sim.recording.scene import Scene
from exo_sim.recording.table import Recording

if TYPE_CHECKING:
    import rerun as rr

Lane = Sequence[tuple[float, str]]

APPLICATION = "exo-sim"
_COLOURS = {
    "recorded": (255, 255, 255, 255),
    "before": (255, 140, 60, 255),
    "after": (80, 200, 120, 255),
    "simulated": (90, 170, 255, 255),
    "free_run": (180, 130, 240, 255),
}
_PALETTE = (
    (90, 170, 255), (255, 140, 60), (80, 200, 120), (230, 90, 100), (180, 130, 240), (240, 200, 70), (120, 220, 220)
)  # fmt: skip
_LANE_COLOURS = {
    "stance": (110, 150, 90),
    "swing": (70, 80, 100),
    "": (45, 48, 54),
}


def write_rrd(
    path: str | Path,
    recording: Recording,
    scene: Scene | None = None,
    overlays: Mapping[str, Recording] | None = None,
    lanes: Mapping[str, Lane] | None = None,
) -> None:
    """Write a recording for the rerun viewer, with its blueprint.

    Args:
        path: Where to.
        recording: Its columns become the entities `/<part>.<signal>`.
        scene: What to draw in space.
        overlays: Other recordings to show on the same plots, e.g. `{"before": ..., "after": ...}`; the entities are
            then `/<part>.<signal>/recorded`, `/before` and `/after`. Each has its own clock. What they differ by from what
            was recorded stands in plots beside, as `/difference/<part>.<signal>/<name>`.
        lanes: Coloured bars below the plots: name to `(time at which it begins, label)`, an empty label for nothing.
            The gait is added by itself where stance is recorded.

    Raises:
        OutputError: the file cannot be written.
    """
    import rerun as rr

    overlays = overlays or {}
    all_lanes = {**gait_lanes(recording), **(lanes or {})}
    overlaid = {key: any(key in other for other in overlays.values()) for key in recording.columns}
    stream = rr.RecordingStream(APPLICATION, recording_id=_identity(recording), send_properties=False)
    with replacing(path) as beside, written(stream, beside):
        layout = blueprint.layout(recording, scene=scene, lanes=list(all_lanes), overlaid=overlaid)
        stream.send_blueprint(layout, make_active=False, make_default=True)
        stream.send_recording_name(recording.name)
        if recording.metadata:
            stream.send_property("exo_sim", rr.AnyValues(drop_untyped_nones=True, **recording.metadata))
        on_top = max(["recorded", *overlays])  # the viewer draws in the order of names
        _signals(stream, recording, "recorded" if overlays else "", overlaid, on_top)
        for name, other in overlays.items():
            _signals(stream, other, name, dict.fromkeys(other.columns, True), on_top)
            _differences(stream, recording, other, name)
        for name, lane in all_lanes.items():
            _lane(stream, name, lane)
        if scene is not None:
            from exo_sim.recording.rrd_scene import draw

            draw(stream, scene)


def gait_lanes(recording: Recording) -> dict[str, Lane]:
    """Return when each foot stands and swings, from `gait.stance_l` and `gait.stance_r`."""
    lanes: dict[str, Lane] = {}
    for side, name in (("r", "right foot"), ("l", "left foot")):
        stance = recording.get(f"gait.stance_{side}")
        if stance is None:
            continue
        on = np.nan_to_num(stance) > 0.5
        starts = np.concatenate(([0], 1 + np.flatnonzero(np.diff(on))))
        lanes[name] = [(float(recording.time[i]), "stance" if on[i] else "swing") for i in starts]
    return lanes


def _identity(recording: Recording) -> str:
    digest = hashlib.sha256(recording.name.encode())
    for key in sorted(recording.metadata):
        digest.update(f"\0{key}\0{recording.metadata[key]}".encode())
    digest.update(recording.time.tobytes())
    for key, values in recording.columns.items():
        digest.update(key.encode())
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()[:32]


def clock(times: NDArray[np.float64]) -> rr.TimeColumn:
    """Return seconds as rerun's timeline `time`."""
    import rerun as rr

    return rr.TimeColumn("time", duration=np.rint(times * 1e9).astype("timedelta64[ns]"))


def turns(values: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which samples a line needs, shape (n,): all but those between two that are equal to them."""
    needed = np.ones(len(values), dtype=bool)
    needed[1:-1] = (values[1:-1] != values[:-2]) | (values[1:-1] != values[2:])
    return needed


def _signals(stream: Any, recording: Recording, leaf: str, overlaid: Mapping[str, bool], on_top: str) -> None:
    import rerun as rr

    index = [clock(recording.time)]
    place = blueprint.places(recording)
    values_of = {unit: rr.AnyValues(unit=unit) for unit in set(recording.units.values())}
    for number, (key, values) in enumerate(recording.columns.items()):
        path, width, name = key, 1.5, blueprint.words(key, recording.units[key])
        colour: tuple[int, ...] = _PALETTE[place.get(key, 0) % len(_PALETTE)]
        if leaf and overlaid.get(key):
            path, name, colour = f"{key}/{leaf}", leaf, _COLOURS.get(leaf, colour)
            width = 1.2 if leaf == on_top else 4.0  # thin, so that the others show behind it
        times, shown = index, values
        if number:  # the first one holds the clock
            told = turns(values)
            if 2 * np.count_nonzero(told) < len(values):
                times, shown = [clock(recording.time[told])], values[told]
        stream.send_columns(path, indexes=times, columns=rr.Scalars.columns(scalars=shown))
        every = None if shown is values else rr.components.AggregationPolicy.Off  # an average of a few turns is none of them
        line = rr.SeriesLines(names=name, colors=[colour], widths=[width], aggregation_policy=every)
        unit = values_of[recording.units[key]]
        if path == key:
            stream.log(path, line, unit, static=True)
        else:
            stream.log(path, line, static=True)
            stream.log(key, unit, static=True)


def _differences(stream: Any, recording: Recording, other: Recording, name: str) -> None:
    """Log how far an overlay is from what was recorded, on the overlay's clock."""
    import rerun as rr

    index = [clock(other.time)]
    for key in other.columns:
        if key not in recording:
            continue
        recorded = recording[key]
        there = np.isfinite(recorded)
        if not np.array_equal(recording.time, other.time) and there.any():
            recorded = np.interp(other.time, recording.time[there], recorded[there])
        path = f"{blueprint.DIFFERENCE}/{key}/{name}"
        stream.send_columns(path, indexes=index, columns=rr.Scalars.columns(scalars=other[key] - recorded))
        looks = rr.SeriesLines(names=name, colors=[_COLOURS.get(name, _PALETTE[0])], widths=[1.5])
        stream.log(path, looks, static=True)


def _lane(stream: Any, name: str, lane: Lane) -> None:
    import rerun as rr

    if not lane:
        return
    path = f"{blueprint.LANES}/{name.replace(' ', '_')}"
    labels = list(dict.fromkeys(label or "-" for _, label in lane))
    colours = [
        _LANE_COLOURS.get("" if label == "-" else label, _PALETTE[i % len(_PALETTE)]) for i, label in enumerate(labels)
    ]
    shown = ["" if label == "-" else label for label in labels]
    visible = [label != "-" for label in labels]
    looks = rr.StateConfiguration(values=labels, labels=shown, colors=colours, visible=visible)
    stream.log(path, looks, static=True)
    stream.send_columns(
        path,
        indexes=[clock(np.array([time for time, _ in lane]))],
        columns=rr.StateChange.columns(state=[label or "-" for _, label in lane]),
    )
