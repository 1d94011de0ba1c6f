"""OpenSim storage keeps every bit, and its coordinates are positions of joints."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recording.one_table import ANGLE, PRESSURE, TIME, foreign

from exo_sim.errors import RecordingError
from exo_sim.recording import Recording, read, write_table


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


def test_two_labels_of_one_coordinate_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "walk.sto"
    rows = "\n".join(f"{t} {a} {2 * a}" for t, a in zip(TIME, ANGLE))
    path.write_text(f"walk\nendheader\ntime knee_angle_r /jointset/knee_r/knee_angle_r/value\n{rows}\n")
    with pytest.raises(RecordingError, match=r"knee_angle_r\.position \[rad\]\" is there 2 times"):
        read(path)
