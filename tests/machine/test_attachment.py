"""Attachment points of the rig move the sites of the model, whatever its wearer's height."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import ModelError, RigError
from exo_sim.machine.attachment import attach, attachments
from exo_sim.machine.person import Person
from exo_sim.machine.rig_model import load
from exo_sim.machine.worn_model import build
from exo_sim.rig import Attachment


@pytest.fixture
def exo(repository):
    return rigs.read(repository / "assets" / "exo_250_psi.toml")


def test_points_are_counted_from_the_joint(exo):
    found = attachments(exo, load(exo))
    assert found["knee_l"].base == pytest.approx((-0.06, 0.33))
    assert found["knee_l"].rod == pytest.approx((-0.03, -0.06))
    assert found["hip_r"].base == pytest.approx((-0.04, -0.06))
    assert found["hip_r"].rod == pytest.approx((0.08, -0.36))


def test_the_same_points_at_another_body_height(exo):
    model = build(exo.model, Person(1.90, 90.0), 20.0, exo.ankle)
    assert attachments(exo, model)["knee_r"].base == pytest.approx((-0.06, 0.33))


def test_moved_points_change_length_as_the_geometry_says(exo):
    base, rod = (-0.05, 0.30), (-0.04, -0.05)
    text = exo.text + '\n[cylinders.knee_l.attachment]\nfrom = ["-50 mm", "300 mm"]\nto = ["-40 mm", "-0.05 m"]\n'
    moved = rigs.parse(text, exo.path)
    assert moved.cylinders["knee_l"].attachment == Attachment(base, rod)
    model = load(moved)
    data = mujoco.MjData(model)
    angle = -0.7
    data.joint("knee_l").qpos[0] = angle
    mujoco.mj_forward(model, data)
    turned = [rod[0] * np.cos(angle) - rod[1] * np.sin(angle), rod[0] * np.sin(angle) + rod[1] * np.cos(angle)]
    assert data.actuator("knee_l").length[0] == pytest.approx(np.hypot(*np.subtract(base, turned)), rel=1e-12)
    assert attachments(moved, model)["knee_l"].base == pytest.approx(base)
    assert attachments(moved, model)["knee_r"].base == pytest.approx((-0.06, 0.33))


def test_without_attachment_nothing_moves(exo):
    model = load(exo)
    before = model.site_pos.copy()
    attach(model, exo)
    assert (model.site_pos == before).all()


@pytest.mark.parametrize("written", ['["1 mm"]', '"1 mm"', '["1 kg", "2 mm"]'])
def test_a_bad_pair_is_one_line(exo, written):
    with pytest.raises(RigError) as error:
        rigs.parse(exo.text + f'\n[cylinders.hip_l.attachment]\nfrom = {written}\nto = ["0 m", "0 m"]\n', exo.path)
    assert "cylinders.hip_l.attachment.from" in str(error.value) and "\n" not in str(error.value)


def test_a_cylinder_on_a_joint_has_no_points(repository):
    bench = rigs.read(repository / "assets" / "bench.toml")
    name = next(iter(bench.cylinders))
    cylinder = replace(bench.cylinders[name], attachment=Attachment((0.0, 0.0), (0.1, 0.0)))
    with pytest.raises(ModelError, match="acts on a joint"):
        load(replace(bench, cylinders={name: cylinder}))
