"""A worn machine's model is the same wherever it is loaded: segments of the rig's wearer, ankles of the rig."""

from __future__ import annotations

import shutil
from pathlib import Path

import mujoco
import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import ModelError
from exo_sim.machine import fitting, mjcf
from exo_sim.machine.person import Person
from exo_sim.machine.rig_model import load
from exo_sim.machine.worn_model import build
from exo_sim.rig import Rig
from exo_sim.rig.schema import Ankle


def worn(repository: Path, folder: Path, *changes: tuple[str, str]) -> Rig:
    """Return the machine that comes along, with lines of its rig changed."""
    text = (repository / "assets" / "exo_250_psi.toml").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    shutil.copy(repository / "assets" / "exo.xml", folder / "exo.xml")
    (folder / "rig.toml").write_text(text)
    return rigs.read(folder / "rig.toml")


@pytest.mark.parametrize("height", ["1.70 m", "1.90 m"])
def test_what_is_diagnosed_is_what_walks(repository: Path, tmp_path: Path, height: str) -> None:
    changes = (('height = "1.70 m"', f'height = "{height}"'), ('stiffness = "100 N m/rad"', 'stiffness = "60 N m/rad"'))
    rig = worn(repository, tmp_path, *changes)
    loaded = load(rig)
    walking = build(rig.model, Person(rig.wearer.height, rig.wearer.mass), 34.0, rig.ankle)
    for name in ("body_pos", "site_pos", "geom_pos", "jnt_stiffness", "body_mass", "qpos0"):
        np.testing.assert_array_equal(getattr(loaded, name), getattr(walking, name), err_msg=name)
    assert loaded.joint("ankle_l").stiffness[0] == 60.0


def test_a_free_ankle_has_no_spring(repository: Path, tmp_path: Path) -> None:
    assert load(worn(repository, tmp_path, ('"sprung"', '"free"'))).joint("ankle_r").stiffness[0] == 0.0


def test_what_a_machine_lacks_to_be_worn_is_listed_by_kind(repository: Path) -> None:
    whole = fitting.missing_parts(mjcf.read_spec(repository / "assets" / "exo.xml"))
    assert whole.keys() == {"joint", "body", "geom", "site", "contact sensor"} and not any(whole.values())
    bench = fitting.missing_parts(mjcf.read_spec(repository / "assets" / "bench.xml"))
    assert "torso_x" in bench["joint"] and "payload" in bench["geom"]


GROUND = '<contact name="ground_l" body1="foot_l" geom2="floor" num="1" reduce="netforce" data="force pos"/>'


def test_the_ground_is_found_whatever_other_sensors_the_machine_has(repository: Path) -> None:
    text = (repository / "assets" / "exo.xml").read_text()
    assert GROUND in text
    model = telling(text.replace(GROUND, f'<jointpos joint="knee_l"/>{GROUND}<jointpos joint="knee_r"/>'))
    assert fitting.ground_sensors(model, Path("mine.xml")) == (1, 11)


def telling(text: str) -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_string(text)
    fitting.tell_moments(spec)
    return spec.compile()


def test_a_sensor_that_tells_the_moment_already_is_one_of_the_ground(repository: Path) -> None:
    text = (repository / "assets" / "exo.xml").read_text().replace("force pos", "force torque pos")
    assert fitting.ground_sensors(telling(text), Path("mine.xml")) == (0, 9)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("netforce", "mindist"), ("force pos", "force dist pos"), ("force pos", "force"), ('num="1"', 'num="2"'),
        ('body1="foot_l"', 'body1="foot_r"'),
    ],
)
def test_a_sensor_of_the_ground_that_measures_something_else_is_refused(repository: Path, old: str, new: str) -> None:
    other = GROUND.replace(f'"{old}"', f'"{new}"') if "=" not in old else GROUND.replace(old, new)
    model = telling((repository / "assets" / "exo.xml").read_text().replace(GROUND, other))
    with pytest.raises(ModelError, match=r'mine\.xml: the sensor "ground_l" must be <contact name="ground_l" body1="foot_l"'):
        fitting.ground_sensors(model, Path("mine.xml"))


def test_a_cylinder_of_any_name_keeps_its_stroke_on_a_taller_wearer(repository: Path, tmp_path: Path) -> None:
    """Sites of a tendon keep their distance from the joint that it spans, also on a body turned and fixed to the thigh."""
    lengths = []
    for height in (1.70, 1.90):
        text = (repository / "assets" / "exo.xml").read_text()
        clamp = '<body pos="0 0 -0.05" euler="0 30 0"><site name="Knie0" pos="-0.06 0 -0.06"/></body>'
        for old, new in ((' <site name="knee_l_base" pos="-0.06 0 -0.11"/>', clamp), ('site="knee_l_base"', 'site="Knie0"')):
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "mine.xml").write_text(text)
        model = build(tmp_path / "mine.xml", Person(height, 80.0), 20.0, Ankle())
        data = mujoco.MjData(model)
        for angle in (0.0, -1.0):
            data.joint("knee_l").qpos[0] = angle
            mujoco.mj_forward(model, data)
            lengths.append([float(data.tendon(name).length[0]) for name in ("knee_l", "knee_r", "hip_l")])
    np.testing.assert_allclose(lengths[:2], lengths[2:], atol=1e-9)


def test_a_link_that_is_a_box_grows_with_the_wearer(repository: Path, tmp_path: Path) -> None:
    text = (repository / "assets" / "exo.xml").read_text()
    capsule = 'name="shank_l" class="link" type="capsule" fromto="0 0 0 0 0 -0.369" size="0.02"'
    assert capsule in text
    box = 'name="shank_l" class="link" type="box" pos="0 0 -0.1845" size="0.02 0.02 0.1845"'
    (tmp_path / "mine.xml").write_text(text.replace(capsule, box))
    model, person = build(tmp_path / "mine.xml", Person(1.90, 80.0), 20.0, Ankle()), Person(1.90, 80.0)
    link = model.geom("shank_l")
    assert [2 * link.size[2], -2 * link.pos[2]] == pytest.approx([person.shank, person.shank])
