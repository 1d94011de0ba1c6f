"""Folders of what other programs write: a bench's recording in their formats, a walk's joint angles, and what users write themselves."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

ASSETS = Path(__file__).resolve().parents[2] / "assets"
#: Of the walk: seconds from sample to sample, of a stride, and strides.
_STEP, _PERIOD, _STRIDES = 0.02, 1.1, 2
_SCENARIO = """strides = 1
[gait]
file = "walk.csv"
from = "0 s"
to = "2.2 s"
knee_l = "knee_l.position"
[added]
mass = "20 kg"
at = 0.5
over = "0.3 s"
"""
_STANDING = """strides = 1
[standing]
period = "3 s"
knee = ["-10 deg", "-90 deg"]
ankle = ["7 deg", "25 deg"]
lean = ["8 deg", "30 deg"]
"""
_CATALOGUE = """[[cylinder]]
maker = "own"
bore = "40 mm"
rod = "12 mm"
strokes = ["80 mm", "100 mm", "160 mm", "200 mm"]
pivot_length = "140 mm"
mass_0 = "0.3 kg"
mass_per_metre = "2 kg/m"
rating = "11 bar"

[[valve]]
name = "large"
C = "1.4 dm^3/(s bar)"
b = 0.3
lag = "10 ms"
mass = "0.1 kg"

[[valve]]
name = "small"
area = "5 mm^2"
"""
_CONTROLLER = """class Mine:
    period = 0.01
    def reset(self, context):
        self.context = context
    def act(self, observation):
        return {name: 0.1 for name in self.context.cylinders}
"""
Columns = dict[str, NDArray[np.float64]]


def recordings(folder: Path, time: NDArray[np.float64], columns: Columns, units: dict[str, str]) -> None:
    """Write a recording of the bench, SI, as MATLAB, ROS 2, OpenSim and LeRobot have it."""
    import h5py
    from scipy.io import savemat

    from exo_sim.recording import Recording
    from exo_sim.recording.opensim_table import write_sto

    headings = ["time [s]", *(f"{key} [{unit}]" for key, unit in units.items())]
    table = np.column_stack([time, *columns.values()])
    savemat(folder / "bench.mat", {"data": table, "headings": np.array(headings, dtype=object)})
    with h5py.File(folder / "bench73.mat", "w") as file:
        file["data"] = table.T
        cells = [file.create_dataset(f"#refs#/{i}", data=np.array([[ord(c)] for c in h], dtype=np.uint16)) for i, h in enumerate(headings)]
        file.create_dataset("headings", data=np.array([[cell.ref for cell in cells]], dtype=h5py.ref_dtype))
    write_sto(folder / "bench.sto", Recording("bench", time, columns, units))
    _mcap(folder / "bench.mcap", time, columns)
    _lerobot(folder, time, columns, units)


def _mcap(path: Path, time: NDArray[np.float64], columns: Columns) -> None:
    from mcap.writer import Writer
    from mcap_ros2.writer import Writer as Ros2Writer

    stamps = [1_700_000_000_000_000_000 + round(1e9 * t) for t in time]
    with path.open("wb") as file, Ros2Writer(file) as writer:
        number = writer.register_msgdef("std_msgs/msg/Float64", "float64 data\n")
        for i, stamp in enumerate(stamps):
            for key, values in columns.items():
                writer.write_message("/" + key.replace(".", "/"), number, {"data": float(values[i])}, stamp, stamp)
    with path.with_name("log.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("/log", "json", 0)
        for i, stamp in enumerate(stamps):
            writer.add_message(channel, stamp, json.dumps({"P1": columns["piston.pressure_1"][i] / 1e5}).encode(), stamp)
        writer.finish()
    path.with_name("log.toml").write_text('[columns]\n"/log.P1" = "piston.pressure_1 [bar]"\n')


def _lerobot(folder: Path, time: NDArray[np.float64], columns: Columns, units: dict[str, str]) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    (folder / "meta").mkdir()
    features = {"observation.state": {"dtype": "float64", "shape": [len(columns)], "names": list(columns)}}
    (folder / "meta" / "info.json").write_text(json.dumps({"features": features}))
    state = pa.FixedSizeListArray.from_arrays(np.column_stack(list(columns.values())).ravel(), len(columns))
    frames: dict[str, Any] = {
        "timestamp": time, "frame_index": np.arange(len(time)), "episode_index": np.zeros(len(time), int), "observation.state": state,
    }  # fmt: skip
    parquet.write_table(pa.table(frames), folder / "episode.parquet")
    lines = [f'"observation.state[{key}]" = "{key} [{unit}]"' for key, unit in units.items()]
    (folder / "episode.toml").write_text("\n".join(["[columns]", *lines]) + "\n")


def walk(folder: Path) -> None:
    """Write a worn machine, two strides in the formats that `--gait` takes, scenario files, a controller and a catalogue."""
    from exo_sim.gait import recorded_gait

    folder.mkdir()
    for name in ("exo_250_psi.toml", "exo.xml"):
        shutil.copyfile(ASSETS / name, folder / name.replace("_250_psi", ""))
    gait, time = recorded_gait.load("falisse"), np.arange(0.0, _STRIDES * _PERIOD + 0.6, _STEP)
    angles: Columns = {}
    for side, shift in (("r", 0.0), ("l", 0.5)):
        phase = time / _PERIOD + shift
        angles[f"hip_{side}"] = gait.recorded["thigh"](phase) - gait.recorded["tilt"](phase)
        angles[f"knee_{side}"], angles[f"ankle_{side}"] = gait.recorded["knee"](phase), gait.recorded["ankle"](phase)
    degrees = {key: np.degrees(values) for key, values in angles.items()}
    _text(folder / "walk.csv", ["time [s]", *(f"{key}.position [deg]" for key in degrees)], [time, *degrees.values()], ",")
    names = {"hip": "hip_flexion_", "knee": "knee_angle_", "ankle": "ankle_angle_"}
    head = f"Coordinates\nversion=1\nnRows={len(time)}\nnColumns={len(degrees) + 1}\ninDegrees=yes\nendheader\n"
    labels = ["time", *(names[key[:-2]] + key[-1] for key in degrees)]
    _text(folder / "walk.mot", labels, [time, *degrees.values()], "\t", head)
    force = 700.0 * (np.sin(2.0 * np.pi * time / _PERIOD) > -0.3)
    forces = [force, np.roll(force, round(0.5 * _PERIOD / _STEP))]
    head = f"forces\nversion=1\nnRows={len(time)}\nnColumns=3\ninDegrees=no\nendheader\n"
    _text(folder / "forces.mot", ["time", "ground_force_r_vy", "ground_force_l_vy"], [time, *forces], "\t", head)
    _c3d(folder / "walk.c3d", degrees)
    texts = {"walk.toml": _SCENARIO, "standing.toml": _STANDING, "catalogue.toml": _CATALOGUE, "mine.py": _CONTROLLER}
    for name, text in texts.items():
        (folder / name).write_text(text)


def _text(path: Path, labels: list[str], columns: list[NDArray[np.float64]], mark: str, head: str = "") -> None:
    rows = [mark.join(f"{value:.6g}" for value in row) for row in np.column_stack(columns)]
    path.write_text(head + "\n".join([mark.join(labels), *rows]) + "\n")


def _c3d(path: Path, degrees: Columns) -> None:
    import ezc3d

    points = np.zeros((4, len(degrees), len(next(iter(degrees.values())))))
    points[1] = 1.0
    for i, (key, values) in enumerate(degrees.items()):
        points[0, i] = -values if key.startswith("knee") else values
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [1.0 / _STEP]
    file["parameters"]["POINT"]["LABELS"]["value"] = [f"{key[-1].upper()}{key[:-2].title()}Angles" for key in degrees]
    file["data"]["points"] = points
    file.write(str(path))
