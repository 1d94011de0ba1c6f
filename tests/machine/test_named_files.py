"""Files that a model names: one that would never end, or never begin, is refused before MuJoCo opens it."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from exo_sim.errors import ModelError
from exo_sim.machine.mjcf import read_spec

_MODEL = '<mujoco>{}<worldbody><body name="b"><geom size="0.1"/></body></worldbody></mujoco>'


def _written(folder: Path, inside: str) -> Path:
    (folder / "m.xml").write_text(_MODEL.format(inside))
    return folder / "m.xml"


@pytest.mark.parametrize(
    "inside",
    [
        '<include file="pipe.xml"/>',
        "<include file = 'pipe.xml'/>",
        '<compiler meshdir="."/><asset><mesh name="m" file="pipe.stl"/></asset>',
        '<compiler assetdir="deep"/><asset><hfield name="m" file="pipe.bin" size="1 1 1 1"/></asset>',
        '<asset><texture name="t" type="cube" fileright="pipe.png"/></asset>',
        '<asset><texture name="t" type="2d" file="/dev/zero"/></asset>',
        '<include file="/dev/zero"/>',
        '<include file="one.xml"/>',
    ],
)
def test_what_is_no_file_is_refused_before_it_is_opened(tmp_path: Path, inside: str) -> None:
    (tmp_path / "deep").mkdir()
    for name in ("pipe.xml", "pipe.stl", "deep/pipe.bin", "pipe.png"):
        os.mkfifo(tmp_path / name)
    (tmp_path / "one.xml").write_text('<mujocoinclude><include file="pipe.xml"/></mujocoinclude>')
    with pytest.raises(ModelError, match=r"it is a (pipe|device), not a file"):
        read_spec(_written(tmp_path, inside))


def test_one_that_includes_itself_comes_to_an_end(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="MuJoCo cannot read it"):
        read_spec(_written(tmp_path, '<include file="m.xml"/>'))


@pytest.mark.parametrize("inside", ["", '<!-- <include file="pipe.xml"/> -->', '<include file="more.xml"/>'])
def test_a_sound_model_is_read(tmp_path: Path, inside: str) -> None:
    os.mkfifo(tmp_path / "pipe.xml")
    (tmp_path / "more.xml").write_text('<mujocoinclude><option timestep="0.003"/></mujocoinclude>')
    spec = read_spec(_written(tmp_path, inside))
    assert spec.option.timestep == (0.003 if "more" in inside else 0.002)
