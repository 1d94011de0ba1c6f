"""Broken C3D files, some of which end or stop the process that hands them to ezc3d: each is read or refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from exo_sim.errors import ScenarioError
from exo_sim.gait.files import c3d
from exo_sim.gait.files.c3d_content import read_content

ezc3d = pytest.importorskip("ezc3d")
_LABELS = ["LHipAngles", "RHipAngles", "LKneeAngles", "RKneeAngles", "LAnkleAngles", "RAnkleAngles"]


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("c3d") / "walk.c3d"
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [50.0]
    file["parameters"]["POINT"]["LABELS"]["value"] = _LABELS
    file["data"]["points"] = np.arange(4.0 * 6 * 140).reshape(4, 6, 140)
    file.write(str(path))
    return path.read_bytes()


def test_a_sound_one_is_read(sound: bytes, tmp_path: Path) -> None:
    (tmp_path / "walk.c3d").write_bytes(sound)
    content = read_content(tmp_path / "walk.c3d")
    assert list(content.labels) == _LABELS and content.rate == 50.0 and content.angle_unit == "deg" and not content.forces
    np.testing.assert_allclose(content.points, np.arange(4.0 * 6 * 140).reshape(4, 6, 140)[:3])


@pytest.mark.parametrize(
    ("at", "put"),
    [
        (550, b"\0" * 64), (782, b"\0" * 64), (523, b"\xb7\x0e\xee\x7f"), (804, b"\xb4\xa2\x89\x6e"), (551, b"\xfa\x9c\x18\x04"),
        (1147, b"\x63\x34\x0a\xff"), (512, b"\xff" * 400),
    ],
)  # fmt: skip
def test_a_broken_one_ends_nobodys_process(sound: bytes, tmp_path: Path, at: int, put: bytes) -> None:
    path = tmp_path / "walk.c3d"
    path.write_bytes(sound[:at] + put + sound[at + len(put) :])
    refused = r"walk\.c3d: (ezc3d cannot read it: .*Copy it again|no column for|it holds .* no joint angles)"
    with pytest.raises(ScenarioError, match=refused) as caught:
        c3d.read_angles(path, {})
    assert "\n" not in str(caught.value)


def test_a_rate_that_is_none_is_refused(sound: bytes, tmp_path: Path) -> None:
    path = tmp_path / "walk.c3d"
    assert sound.count(np.float32(50.0).tobytes()) >= 1
    path.write_bytes(sound.replace(np.float32(50.0).tobytes(), np.float32(-50.0).tobytes()))
    with pytest.raises(ScenarioError, match="says -50 frames a second"):
        c3d.read_angles(path, {})


def with_plates(path: Path, kind: int, more: dict[str, object] | None = None, channels: int = 6) -> Path:
    """Write a trial with two plates, as ezc3d writes it: whole numbers of FORCE_PLATFORM become fractions, which it refuses to read."""
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [50.0]
    file["parameters"]["POINT"]["LABELS"]["value"] = _LABELS
    file["data"]["points"] = np.ones((4, 6, 20))
    file["parameters"]["ANALOG"]["RATE"]["value"] = [100.0]
    file["parameters"]["ANALOG"]["LABELS"]["value"] = [f"c{i}" for i in range(2 * channels)]
    file["data"]["analogs"] = np.arange(2.0 * channels)[None, :, None] * np.ones(40)
    for name, value in {
        "USED": [2], "TYPE": [kind, kind], "CHANNEL": np.arange(1.0, 2 * channels + 1).reshape(2, channels).T,
        "ZERO": [1, 0], "CORNERS": np.ones((3, 4, 2)), "ORIGIN": np.ones((3, 2)), **(more or {}),
    }.items():  # fmt: skip
        file.add_parameter("FORCE_PLATFORM", name, value)
    file.write(str(path))
    return path


@pytest.mark.parametrize(
    ("kind", "channels", "forces"),
    [
        (2, 6, [(0.0, 1.0, 2.0), (6.0, 7.0, 8.0)]), (3, 8, [(1.0, 5.0, 22.0), (17.0, 21.0, 54.0)]),
        (4, 6, [(0.0, 2.0, 6.0), (6.0, 14.0, 24.0)]),
    ],
)
def test_plates_that_ezc3d_refuses_are_read_by_the_types_of_the_format(
    tmp_path: Path, kind: int, channels: int, forces: list[tuple[float, float, float]]
) -> None:
    scale = np.repeat(np.diag([1.0, 2.0, 3.0, 1.0, 1.0, 1.0])[:, :, None], 2, axis=2)
    content = read_content(with_plates(tmp_path / "walk.c3d", kind, {"CAL_MATRIX": scale}, channels))
    assert not content.refused and [tuple(force[:, -1]) for force in content.forces] == forces
    assert content.forces[0].shape == (3, 40)


def test_plates_of_which_nothing_is_known_are_left_aside_and_said(tmp_path: Path) -> None:
    path = with_plates(tmp_path / "walk.c3d", 77)
    trial, ground = c3d.read_angles(path, {})
    assert ground is None and "force plates are left aside" in trial.remarks[0]
    with pytest.raises(ScenarioError, match=r"walk\.c3d: it holds no force plates that are read: ezc3d says"):
        c3d.read_ground(path)


def test_markers_without_angles_are_refused_with_the_way_to_angles(tmp_path: Path) -> None:
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [50.0]
    file["parameters"]["POINT"]["LABELS"]["value"] = ["LHEE", "RHEE", "LASI", "RASI", "SACR"]
    file["data"]["points"] = np.ones((4, 5, 40))
    file.write(str(tmp_path / "markers.c3d"))
    with pytest.raises(ScenarioError, match=r"holds 5 points \(LHEE, RHEE, LASI, RASI, \.\.\.\) and no joint angles.*Inverse Kinematics"):
        c3d.read_angles(tmp_path / "markers.c3d", {})
