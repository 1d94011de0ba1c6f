"""MCAP files, bags of ROS 2 among them, give the table that went into them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from recording.one_table import ANGLE, PRESSURE, TIME, N, foreign, is_the_table

from exo_sim.errors import RecordingError
from exo_sim.recording import read


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


def test_two_topics_of_one_signal_are_refused(tmp_path: Path) -> None:
    pytest.importorskip("mcap_ros2")
    from mcap_ros2.writer import Writer

    path = tmp_path / "bag.mcap"
    with path.open("wb") as file, Writer(file) as writer:
        number = writer.register_msgdef("std_msgs/msg/Float64", "float64 data\n")
        for i in range(N):
            for robot in ("one", "two"):
                writer.write_message(f"/{robot}/piston/valve_command", number, {"data": 0.1}, i * 10**7, i * 10**7)
    with pytest.raises(RecordingError, match=r"piston\.valve_command \[1\]\" is there 2 times"):
        read(path)


def test_what_is_none_is_said_to_be_no_whole_file(tmp_path: Path) -> None:
    pytest.importorskip("mcap_ros2")
    (tmp_path / "bag.mcap").write_bytes(b"\x89MCAP0\r\n")
    with pytest.raises(RecordingError, match="not a whole MCAP file"):
        read(tmp_path / "bag.mcap")
