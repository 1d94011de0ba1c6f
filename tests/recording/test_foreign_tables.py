"""Files that people have: each reader gives the table that went into the file, and refuses what is broken in one line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from exo_sim.errors import RecordingError
from exo_sim.recording import Recording, read, write_table
from exo_sim.recording.column_map import column_map_of

N = 200
TIME = np.arange(N, dtype=np.float64) * 0.01
PRESSURE = 2e5 + 1e4 * np.sin(TIME)
ANGLE = 0.3 * np.cos(TIME)
HEADINGS = ["time [s]", "piston.pressure_1 [bar]", "knee.position [deg]"]
TABLE = np.column_stack([TIME, PRESSURE / 1e5, np.rad2deg(ANGLE)])


def foreign(columns: dict[str, Any], **options: Any) -> Any:
    return column_map_of({"columns": columns, "file": options}, Path("map.toml"))


def is_the_table(recording: Recording, shift: float = 0.0) -> None:
    np.testing.assert_allclose(recording.time, TIME - shift, atol=1e-9)
    np.testing.assert_allclose(recording["piston.pressure_1"], PRESSURE, rtol=1e-12)
    np.testing.assert_allclose(recording["knee.position"], ANGLE, atol=1e-12)


MAP = {"log.t": "time [s]", "log.P1": "piston.pressure_1 [bar]", "angles(:,1)": "knee.position [deg]"}


def test_a_mat_file_of_version_5(tmp_path: Path) -> None:
    from scipy.io import savemat

    path = tmp_path / "run.mat"
    savemat(path, {"log": {"t": TIME, "P1": TABLE[:, 1]}, "angles": TABLE[:, 2:].repeat(2, 1), "note": "a text"})
    is_the_table(read(path, foreign(MAP)).recording)
    with pytest.raises(RecordingError, match=r'no column "time \[s\]".*there is: "log.t"'):
        read(path)
    savemat(path, {"data": TABLE, "headings": np.array(HEADINGS, dtype=object)})
    is_the_table(read(path).recording)
    savemat(path, {"log": {"t": TIME, "P1": TABLE[:-1, 1]}, "angles": TABLE[:, 2:].repeat(2, 1)})
    with pytest.raises(RecordingError, match="199 samples, the time 200"):
        read(path, foreign(MAP))


def test_a_mat_file_of_version_7_3(tmp_path: Path) -> None:
    """As MATLAB writes it: HDF5 behind a block of 512 bytes, matrices with columns first, characters as numbers, cells as references."""
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "run.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["log/t"], file["log/P1"] = TIME[None], TABLE[:, 1][None]
        file["angles"] = TABLE[:, 2:].repeat(2, 1).T
        note = file.create_dataset("note", data=np.array([[ord(c)] for c in "text"], dtype=np.uint16))
        note.attrs["MATLAB_class"] = np.bytes_("char")
    is_the_table(read(path, foreign(MAP)).recording)
    with h5py.File(path, "w") as file:
        file["data"] = TABLE.T
        cells = [file.create_dataset(f"#refs#/{i}", data=np.array([[ord(c)] for c in h], dtype=np.uint16)) for i, h in enumerate(HEADINGS)]
        file.create_dataset("headings", data=np.array([[cell.ref for cell in cells]], dtype=h5py.ref_dtype))
    is_the_table(read(path).recording)


def joint_states(path: Path) -> None:
    from mcap_ros2.writer import Writer

    header = "std_msgs/Header header\n"
    states = header + "string[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n" + "=" * 80 + (
        "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + "=" * 80 +
        "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n")  # fmt: skip
    pressure = header + "float64 fluid_pressure\nfloat64 variance\n" + states[states.index("=" * 80) :]
    with path.open("wb") as file, Writer(file) as writer:
        joints = writer.register_msgdef("sensor_msgs/msg/JointState", states)
        fluid = writer.register_msgdef("sensor_msgs/msg/FluidPressure", pressure)
        for i in range(N):
            ns = 1_700_000_000_000_000_000 + i * 10_000_000
            stamp = {"stamp": {"sec": ns // 10**9, "nanosec": ns % 10**9}, "frame_id": ""}
            writer.write_message("/joint_states", joints, {"header": stamp, "name": ["hip", "knee"], "position": [0.1, ANGLE[i]],
                                 "velocity": [0.0, 0.0], "effort": []}, ns + 10**6, ns + 10**6)  # fmt: skip
            content = {"header": stamp, "fluid_pressure": PRESSURE[i], "variance": 0.0}
            writer.write_message("/robot/piston/pressure_1", fluid, content, ns + 2 * 10**6, ns)


def test_a_bag_of_ros_2(tmp_path: Path) -> None:
    pytest.importorskip("mcap_ros2")
    joint_states(tmp_path / "bag.mcap")
    reading = read(tmp_path / "bag.mcap")
    np.testing.assert_allclose(reading.recording.time, TIME, atol=1e-6)
    np.testing.assert_allclose(reading.recording["knee.position"], ANGLE)
    np.testing.assert_allclose(reading.recording["piston.pressure_1"], PRESSURE)
    assert any("radian was taken" in finding.says for finding in reading.findings)
    names = {"/joint_states.position[knee]": "slide.position [mm]", "/robot/piston/pressure_1.fluid_pressure": "piston.pressure_2 [Pa]"}
    mapped = read(tmp_path / "bag.mcap", foreign(names)).recording
    np.testing.assert_allclose(mapped["slide.position"], 1e-3 * ANGLE)
    np.testing.assert_allclose(mapped["piston.pressure_2"], PRESSURE)


def test_messages_in_json(tmp_path: Path) -> None:
    pytest.importorskip("mcap")
    from mcap.writer import Writer

    path = tmp_path / "log.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("/log", "json", 0)
        for i in range(N):
            data = json.dumps({"P1": PRESSURE[i] / 1e5, "q": [0.0, np.rad2deg(ANGLE[i])]}).encode()
            writer.add_message(channel, i * 10_000_000 + 5, data, 0)
        writer.finish()
    is_the_table(read(path, foreign({"/log.P1": "piston.pressure_1 [bar]", "/log.q[1]": "knee.position [deg]"})).recording)


@pytest.mark.parametrize("names", [["P1", "q"], {"motors": ["P1", "q"]}])
def test_a_lerobot_episode(tmp_path: Path, names: Any) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    path = tmp_path / "data" / "chunk-000" / "episode_000001.parquet"
    path.parent.mkdir(parents=True)
    (tmp_path / "meta").mkdir()
    info = {"features": {"observation.state": {"dtype": "float64", "shape": [2], "names": names}, "timestamp": {"names": None}}}
    (tmp_path / "meta" / "info.json").write_text(json.dumps(info))
    frames = {"timestamp": TIME, "frame_index": np.arange(N), "episode_index": np.full(N, 1), "task_index": np.zeros(N, int),
              "observation.state": pa.FixedSizeListArray.from_arrays(TABLE[:, 1:].ravel(), 2)}  # fmt: skip
    parquet.write_table(pa.table(frames), path)
    columns = {"observation.state[P1]": "piston.pressure_1 [bar]", "observation.state[q]": "knee.position [deg]"}
    is_the_table(read(path, foreign(columns)).recording)
    several = pa.concat_tables([pa.table(frames), pa.table({**frames, "episode_index": np.full(N, 2)})])
    parquet.write_table(several, path)
    with pytest.raises(RecordingError, match="2 episodes, 1 to 2"):
        read(path, foreign(columns))
    is_the_table(read(path, foreign(columns, episode=2)).recording)
    (tmp_path / "meta" / "info.json").write_text("[]")
    with pytest.raises(RecordingError, match=r"info\.json"):
        read(path, foreign(columns, episode=2))


def test_a_storage_file_keeps_every_bit(tmp_path: Path) -> None:
    signals, units = {"piston.pressure_1": PRESSURE, "knee.position": ANGLE}, {"piston.pressure_1": "Pa", "knee.position": "rad"}
    recording = Recording("r", TIME, signals, units)
    write_table(tmp_path / "r.sto", recording)
    again = read(tmp_path / "r.sto").recording
    np.testing.assert_array_equal(again["piston.pressure_1"], PRESSURE)
    np.testing.assert_array_equal(again["knee.position"], ANGLE)


def test_coordinates_of_opensim_are_positions_of_joints(tmp_path: Path) -> None:
    path = tmp_path / "walk.mot"
    rows = "\n".join(f"{t} {np.rad2deg(a)} 1.0 5.0 0.0" for t, a in zip(TIME, ANGLE))
    labels = "time knee_angle_r pelvis_ty /jointset/hip/hip_r/speed knee_angle_r_moment"
    path.write_text(f"walk\ninDegrees=yes\nendheader\n{labels}\n{rows}\n")
    reading = read(path)
    np.testing.assert_allclose(reading.recording["knee_angle_r.position"], ANGLE)
    assert reading.recording.units == {"knee_angle_r.position": "rad", "pelvis_ty.position": "m", "hip_r.velocity": "rad/s"}
    assert [finding.column for finding in reading.findings] == ["knee_angle_r_moment"]
    columns = {"time": "time [s]", "knee_angle_r": "knee.position [deg]", "pelvis_ty": "piston.pressure_1 [bar]"}
    np.testing.assert_allclose(read(path, foreign(columns)).recording["knee.position"], ANGLE)


@pytest.mark.parametrize("ending", [".mat", ".mcap", ".sto", ".mot", ".parquet"])
@pytest.mark.parametrize("content", [
    b"x", b"MATLAB 5.0 MAT-file" + bytes(500), b"\x89HDF\r\n\x1a\n" + bytes(100), b"\x89MCAP0\r\n" + bytes(99),
])  # fmt: skip
def test_what_is_no_such_file_is_one_line(tmp_path: Path, ending: str, content: bytes) -> None:
    path = tmp_path / f"broken{ending}"
    path.write_bytes(content)
    with pytest.raises(RecordingError) as caught:
        read(path)
    assert "\n" not in str(caught.value) and "broken" in str(caught.value)
