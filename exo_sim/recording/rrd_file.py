"""Writing an .rrd: signals, scene, lanes and blueprint in one file that opens in the rerun viewer.

Of a signal that mostly keeps its value only the turns are written: a line through them is the signal. What a reader of the file gets
back is the same for the same recording. The bytes are not: rerun stamps every chunk and every view of the blueprint with an identifier
from clock and chance. The table beside it (`write_table`) is the same byte for byte.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.outputs import replacing
from exo_sim.recording import arrow_without_pandas, blueprint, rrd_names, rrd_scalars
from exo_sim.recording.rrd_sink import written
from exo_sim.recording.rrd_timeline import clock
from exo_sim.recording.scene import Scene
from exo_sim.recording.table import Recording

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
_STANCES = ("stance", "swing")
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
        recording: Its columns become the entities `/<part>/<signal>`, in the unit beside them (`rrd_names`).
        scene: What to draw in space.
        overlays: Other recordings to show on the same plots, e.g. `{"before": ..., "after": ...}`; the entities are
            then `/<part>/<signal>/recorded`, `/before` and `/after`. Each has its own clock. What they differ by from what
            was recorded stands in plots beside, as `/difference/<part>/<signal>/<name>`.
        lanes: Coloured bars below the plots: name to `(time at which it begins, label)`, an empty label for nothing.
            The gait is added by itself where stance is recorded.

    Raises:
        OutputError: the file cannot be written.
    """
    with replacing(path) as beside, writing_rrd(beside, overlays=overlays, lanes=lanes) as pieces:
        pieces.add(recording, scene)


@contextmanager
def writing_rrd(
    path: Path, overlays: Mapping[str, Recording] | None = None, lanes: Mapping[str, Lane] | None = None, footer: bool = True
) -> Iterator[RrdPieces]:
    """Give what writes a recording into `path` piece by piece, straight; after each piece all of it is in the file.

    Args:
        path: Where to.
        overlays, lanes: As in `write_rrd`.
        footer: End the file with a list of its contents, which takes memory for every piece; a viewer opens it quicker.

    Raises:
        OSError: the file cannot be written.
    """
    arrow_without_pandas.settle()
    with ExitStack() as stack:
        yield RrdPieces(path, stack, overlays or {}, lanes or {}, footer)


class RrdPieces:
    """Writes a recording into an .rrd; `writing_rrd` gives one. What the first piece holds sets columns, name and layout."""

    def __init__(
        self, path: Path, stack: ExitStack, overlays: Mapping[str, Recording], lanes: Mapping[str, Lane], footer: bool
    ) -> None:
        self._path, self._stack, self._footer = path, stack, footer
        self._overlays, self._lanes = overlays, lanes
        self._stream: Any = None
        self._drawing: Any = None
        self._stances: dict[str, str] = {}
        self._unaveraged: set[str] = set()

    def add(self, recording: Recording, scene: Scene | None = None) -> None:
        """Write the next piece: the columns of the first, at later times."""
        first = self._stream is None
        if first:
            self._begin(recording, scene)
        self._signals(recording, "recorded" if self._overlays else "", first)
        for name, lane in gait_lanes(recording).items():
            self._gait(name, lane, first)
        if self._drawing is not None and scene is not None:
            self._drawing.add(scene)
        self._stream.flush()

    def _begin(self, recording: Recording, scene: Scene | None) -> None:
        import rerun as rr

        self._stream = stream = rr.RecordingStream(APPLICATION, recording_id=_identity(recording), send_properties=False)
        self._stack.enter_context(written(stream, self._path, self._footer))
        names = list({**gait_lanes(recording), **self._lanes})
        self._overlaid = {key: any(key in other for other in self._overlays.values()) for key in recording.columns}
        layout = blueprint.layout(recording, scene=scene, lanes=names, overlaid=self._overlaid)
        stream.send_blueprint(layout, make_active=False, make_default=True)
        stream.send_recording_name(recording.name)
        if recording.metadata:
            stream.send_property("exo_sim", rr.AnyValues(drop_untyped_nones=True, **recording.metadata))
        for name, other in self._overlays.items():
            self._signals(other, name, True)
            _differences(stream, recording, other, name)
        for name, lane in self._lanes.items():
            _lane(stream, name, lane, tuple(dict.fromkeys(label for _, label in lane)))
        if scene is not None:
            from exo_sim.recording.rrd_scene import Drawing

            self._drawing = Drawing(stream)

    def _signals(self, recording: Recording, leaf: str, first: bool) -> None:
        import rerun as rr

        index = [clock(recording.time)]
        place = blueprint.places(recording) if first else {}
        on_top = max(["recorded", *self._overlays])  # the viewer draws in the order of names
        values_of = {unit: rr.AnyValues(unit=rrd_names.shown(unit)[0]) for unit in set(recording.units.values())}
        for number, (key, values) in enumerate(recording.columns.items()):
            below = leaf and (self._overlaid.get(key) or leaf != "recorded")
            entity, factor = rrd_names.entity(key), rrd_names.shown(recording.units.get(key, ""))[1]
            path = f"{entity}/{leaf}" if below else entity
            times, shown = index, values
            if number:  # the first one holds the clock
                kept = turns(values)
                if kept is not None:
                    times, shown = [clock(recording.time[kept])], values[kept]
            written_as = shown if factor == 1.0 else shown * factor
            self._stream.send_columns(path, indexes=times, columns=rrd_scalars.column(written_as))
            unaveraged = shown is not values  # an average of a few turns is none of them
            if unaveraged and not first and path not in self._unaveraged:
                self._stream.log(path, rr.SeriesLines.from_fields(aggregation_policy=rr.components.AggregationPolicy.Off), static=True)
            if unaveraged:
                self._unaveraged.add(path)
            if not first:
                continue
            every = rr.components.AggregationPolicy.Off if unaveraged else None
            name, width = blueprint.words(key, recording.units[key]), 1.5
            colour: tuple[int, ...] = _PALETTE[place.get(key, 0) % len(_PALETTE)]
            if below:
                name, colour = leaf, _COLOURS.get(leaf, colour)
                width = 1.2 if leaf == on_top else 4.0  # thin, so that the others show behind it
            line = rr.SeriesLines(names=name, colors=rrd_scalars.colour(colour), widths=rrd_scalars.width(width), aggregation_policy=every)
            unit = values_of[recording.units[key]]
            if below:
                self._stream.log(path, line, static=True)
                self._stream.log(entity, unit, static=True)
            else:
                self._stream.log(path, line, unit, static=True)

    def _gait(self, name: str, lane: Lane, first: bool) -> None:
        """Log when a foot begins to stand or swing; what it did before goes on."""
        if self._stances.get(name) == lane[0][1]:
            lane = lane[1:]
        if lane:
            self._stances[name] = lane[-1][1]
        _lane(self._stream, name, lane, _STANCES if first else ())


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


def turns(values: NDArray[np.float64]) -> NDArray[np.bool_] | None:
    """Return which samples a line needs, shape (n,): all but those between two that are equal to them; None for half of all or more."""
    other = values[1:] != values[:-1]
    if 2 * np.count_nonzero(other) > len(values):  # each is before a sample that is needed
        return None
    needed = np.ones(len(values), dtype=bool)
    needed[1:-1] = other[:-1] | other[1:]
    return needed if 2 * np.count_nonzero(needed) < len(values) else None


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
        path = f"{blueprint.DIFFERENCE}/{rrd_names.entity(key)}/{name}"
        apart = (other[key] - recorded) * rrd_names.shown(recording.units.get(key, ""))[1]
        stream.send_columns(path, indexes=index, columns=rrd_scalars.column(apart))
        looks = rr.SeriesLines(names=name, colors=[_COLOURS.get(name, _PALETTE[0])], widths=[1.5])
        stream.log(path, looks, static=True)


def _lane(stream: Any, name: str, lane: Lane, looks: Sequence[str]) -> None:
    """Log a lane; first how its labels look, where any are given."""
    import rerun as rr

    path = f"{blueprint.LANES}/{name.replace(' ', '_')}"
    if looks:
        labels = [label or "-" for label in looks]
        colours = [
            _LANE_COLOURS.get("" if label == "-" else label, _PALETTE[i % len(_PALETTE)]) for i, label in enumerate(labels)
        ]
        shown = ["" if label == "-" else label for label in labels]
        visible = [label != "-" for label in labels]
        stream.log(path, rr.StateConfiguration(values=labels, labels=shown, colors=colours, visible=visible), static=True)
    if lane:
        stream.send_columns(
            path,
            indexes=[clock(np.array([time for time, _ in lane]))],
            columns=rr.StateChange.columns(state=[label or "-" for _, label in lane]),
        )
