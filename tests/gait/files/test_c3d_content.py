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
    with pytest.raises(ScenarioError, match=r"walk\.c3d: (ezc3d cannot read it: .*Copy it again|no column for)") as caught:
        c3d.read_angles(path, {})
    assert "\n" not in str(caught.value)


def test_a_rate_that_is_none_is_refused(sound: bytes, tmp_path: Path) -> None:
    path = tmp_path / "walk.c3d"
    assert sound.count(np.float32(50.0).tobytes()) >= 1
    path.write_bytes(sound.replace(np.float32(50.0).tobytes(), np.float32(-50.0).tobytes()))
    with pytest.raises(ScenarioError, match="says -50 frames a second"):
        c3d.read_angles(path, {})
