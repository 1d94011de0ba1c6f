"""OpenSim's storage files: read as it means them, refused in one line; they keep every bit, and coordinates are positions of joints."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recording.one_table import ANGLE, PRESSURE, TIME, foreign

from exo_sim.errors import RecordingError
from exo_sim.recording import Recording, read, write_table
from exo_sim.recording.opensim_table import is_translation, read_storage

HEADER = "Coordinates\nversion=1\nnRows=3\nnColumns=3\ninDegrees=yes\n\nUnits are S.I. units\nendheader\n"
BODY = "time\tpelvis_tx\tknee_angle_r\n0.0\t1.0\t-90\n0.1\t1.1\t-45\n0.2\t1.2\t0\n"


def storage(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "walk.mot"
    path.write_text(text)
    return path


def test_angles_become_radian_and_lengths_stay(tmp_path: Path) -> None:
    table = read_storage(storage(tmp_path, HEADER + BODY))
    assert table.name == "Coordinates" and table.in_degrees and table.header["nrows"] == "3"
    np.testing.assert_allclose(table.time, [0.0, 0.1, 0.2])
    np.testing.assert_allclose(table.coordinate("knee_angle_r"), [-np.pi / 2, -np.pi / 4, 0.0])
    np.testing.assert_allclose(table.coordinate("pelvis_tx"), [1.0, 1.1, 1.2])
    np.testing.assert_allclose(table.columns["knee_angle_r"], [-90.0, -45.0, 0.0])  # as written


def test_a_file_that_says_nothing_is_in_radian(tmp_path: Path) -> None:
    """OpenSim's Storage takes inDegrees for "no" where it is absent."""
    table = read_storage(storage(tmp_path, "endheader\ntime a\n0 1\n1 2\n"))
    assert not table.in_degrees and table.name == "walk"
    np.testing.assert_allclose(table.angle("a"), [1.0, 2.0])


def test_spaces_empty_cells_and_line_ends_of_windows(tmp_path: Path) -> None:
    text = "x\r\nnRows 2\r\nendheader\r\n\r\ntime\ta\tb\t\r\n 0.0\t\t 2\r\n  1.0 \t 3\tnan\r\n\r\n"
    table = read_storage(storage(tmp_path, text))
    np.testing.assert_array_equal(table.columns["a"], [np.nan, 3.0])
    np.testing.assert_array_equal(table.columns["b"], [2.0, np.nan])


@pytest.mark.parametrize("label, length", [
    ("pelvis_tx", True), ("/jointset/ground_pelvis/pelvis_ty/value", True), ("knee_angle_r", False),
    ("/jointset/knee_r/knee_angle_r/speed", False),
])  # fmt: skip
def test_which_coordinates_are_lengths(label: str, length: bool) -> None:
    assert is_translation(label) is length


@pytest.mark.parametrize("text, says", [
    ("time,a\n0,1\n", 'no line "endheader"'),
    ("x\nendheader\n", "no line of labels"),
    ("x\nendheader\ntime a\n", "no row below"),
    ("x\nendheader\ntime\n0\n", "no column beside the time"),
    ("x\nendheader\na time\n0 1\n", 'must be "time"'),
    ("x\nendheader\ntime a a\n0 1 2\n", "twice"),
    ("x\nendheader\ntime a\n0 1\n0.1\n", "line 5 has 1 numbers under 2 labels"),
    ("x\nendheader\ntime a\n0 1\n0.1 one\n", 'line 5 holds "one"'),
    ("x\nDataType=Vec3\nendheader\ntime a\n0 1,2,3\n", "its cells are Vec3"),
    ("x\ninDegrees=maybe\nendheader\ntime a\n0 1\n", "inDegrees=maybe"),
    ("x\n\0endheader\n", "not text"),
])  # fmt: skip
def test_what_is_no_storage_file_is_refused(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(RecordingError, match=says):
        read_storage(storage(tmp_path, text))


def test_a_label_that_is_not_there_names_the_nearest(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match='did you mean "knee_angle_r"'):
        read_storage(storage(tmp_path, HEADER + BODY)).angle("knee_angle_l")
    with pytest.raises(RecordingError, match="no such file"):
        read_storage(tmp_path / "absent.mot")


@pytest.mark.real_data
def test_files_that_opensim_wrote(shared_data: Path) -> None:
    folder = shared_data / "walking_opensim"
    motion = read_storage(folder / "subject01_walk_IK.mot")
    assert motion.in_degrees and len(motion.time) == int(motion.header["nrows"]) == 151
    knee = np.rad2deg(motion.coordinate("knee_angle_r"))
    assert -75 < knee.min() < -60 and 0 < knee.max() < 10  # the readme beside the files: about -69 to 5 degrees
    assert 0.9 < motion.coordinate("pelvis_ty").mean() < 1.1
    moments = read_storage(folder / "subject01_walk_ID.sto")
    assert not moments.in_degrees and -70 < moments.columns["knee_angle_r_moment"].min() < -60
    forces = read_storage(folder / "subject01_walk_grf.mot")
    assert len(forces.time) == 1501 and 780 < forces.columns["ground_force_vy"].max() < 840


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
