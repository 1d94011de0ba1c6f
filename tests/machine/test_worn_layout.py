"""A worn MJCF of one's own that has all names but is laid out otherwise is refused in one line that says what to write."""

from __future__ import annotations

from pathlib import Path

import pytest

from exo_sim.errors import ModelError
from exo_sim.machine import mjcf, worn_layout


def laid_out(repository: Path, folder: Path, *changes: tuple[str, str]) -> None:
    text = (repository / "assets" / "exo.xml").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (folder / "mine.xml").write_text(text)
    worn_layout.check(mjcf.compiled(mjcf.read_spec(folder / "mine.xml"), folder / "mine.xml"), folder / "mine.xml")


def test_the_machine_that_comes_along_passes(repository: Path, tmp_path: Path) -> None:
    laid_out(repository, tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('<geom name="payload"', '<geom mass="1" size="0.1"/></body><body name="box"><geom name="payload"', 'to the body "payload"'),
        (' ref="0.879"', "", r'torso_z" calls 0 m; write ref="0.879"'),
        ('axis="0 -1 0"', 'axis="0 1 0"', r'the joint "hip_l" of a worn machine is a hinge .* about the axis 0 -1 0'),
        ('type="slide" axis="1 0 0"', 'type="hinge" axis="1 0 0"', r'the joint "torso_x" of a worn machine is a slide'),
        ('name="person_shank_r" mocap="true"', 'name="person_shank_r"', r'the body "person_shank_r" follows .* mocap="true"'),
        ('<default class="person">\n      <geom contype="0"', '<default class="person">\n      <geom contype="1"', "straps are what joins"),
        ('name="heel_r" class="sole"', 'name="heel_r" class="sole" type="box" size=".02 .02 .02"', r'"heel_r" of a worn .* type="sphere"'),
        ('name="toe_l" class="sole"', 'name="toe_l" class="sole" contype="0"', r'"toe_l" never touches'),
        ('name="floor" type="plane" size="0 0 0.1"', 'name="floor" type="box" size="5 5 1" pos="0 0 -1"', 'write type="plane"'),
        ('name="floor"', 'name="floor" pos="0 0 -0.1"', r'the sole "heel_l" is 100 mm above'),
        ('name="shank_l" pos="0 0 -0.440"', 'name="shank_l" pos="0 0 -0.475"', r'the sole "heel_l" is 35 mm below'),
    ],
)  # fmt: skip
def test_what_is_laid_out_otherwise_is_said(repository: Path, tmp_path: Path, old: str, new: str, says: str) -> None:
    with pytest.raises(ModelError, match=rf"mine\.xml: .*{says}"):
        laid_out(repository, tmp_path, (old, new))


def test_the_person_stands_in_order(repository: Path, tmp_path: Path) -> None:
    changes = (('"person_foot_l"', '"other"'), ('"person_foot_r"', '"person_foot_l"'), ('"other"', '"person_foot_r"'))
    with pytest.raises(ModelError, match="in the order person_torso, person_thigh_l"):
        laid_out(repository, tmp_path, *changes)
