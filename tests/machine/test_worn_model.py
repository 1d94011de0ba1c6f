"""The machine as built: opens as it is, masses and lengths right, cylinders with a lever over the whole range."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import ModelError, ScenarioError
from exo_sim.machine.attachment import attach
from exo_sim.machine.linkage import check_strokes, moment_row
from exo_sim.machine.person import COORDINATES, SEGMENTS, Person
from exo_sim.machine.worn_model import build
from exo_sim.rig import Ankle, JointFactors


@pytest.fixture(scope="module")
def assets(repository: Path) -> Path:
    return repository / "assets"


@pytest.mark.parametrize("name", ["exo", "exo_250_psi", "bench"])
def test_the_assets_open_as_they_are_and_their_rigs_fit(assets, name):
    rig = rigs.read(assets / f"{name}.toml")
    model = mujoco.MjModel.from_xml_path(str(rig.model))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data)
    assert not any(warning.number for warning in data.warning)
    attach(model, rig)
    check_strokes(rig, model)


def test_the_example_bench_is_the_contracts(assets):
    piston = rigs.read(assets / "bench.toml").cylinders["piston"]
    assert (piston.bore, piston.rod, piston.stroke, piston.valve_area) == (0.032, 0.012, 0.160, 5e-6)
    assert (piston.dead_volume_1, piston.dead_volume_2, piston.single_acting) == (12e-6, 10e-6, False)


@pytest.mark.parametrize("payload", [0.0, 20.0, 45.0])
def test_frame_and_payload_weigh_what_they_should(assets, payload):
    model = build(assets / "exo.xml", Person(), payload, Ankle())
    assert model.body_subtreemass[model.body("torso").id] == pytest.approx(20.0 + payload, abs=1e-5)
    person = [model.body(f"person_{segment}").id for segment in SEGMENTS]
    assert np.all(model.body_mass[person] == 0.0)


def test_a_rig_may_know_damping_better_than_the_file(assets):
    known = (None, {"knee_l": JointFactors(damping=0.25)})
    plain, softer = (build(assets / "exo.xml", Person(), 34.0, Ankle(), joints=factors) for factors in known)
    knee = plain.joint("knee_l").dofadr[0]
    assert softer.dof_damping[knee] == 0.25 * plain.dof_damping[knee] > 0.0
    others = np.arange(plain.nv) != knee
    np.testing.assert_array_equal(softer.dof_damping[others], plain.dof_damping[others])
    with pytest.raises(ModelError, match=r"joints.kne_l.*did you mean .knee_l"):
        build(assets / "exo.xml", Person(), 34.0, Ankle(), joints={"kne_l": JointFactors(0.5)})


@pytest.mark.parametrize("height", [1.50, 1.70, 2.00])
def test_any_wearer_stands_with_feet_on_the_ground_and_the_same_cylinders(assets, height):
    person = Person(height)
    model = build(assets / "exo.xml", person, 34.0, Ankle())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for tip in ("heel_l", "toe_l", "heel_r", "toe_r"):
        geom = model.geom(tip).id
        assert data.geom_xpos[geom, 2] - model.geom_size[geom, 0] == pytest.approx(0.0, abs=1e-9)
    assert data.xpos[model.body("foot_l").id, 2] == pytest.approx(person.ankle_height)
    drawn = mujoco.MjModel.from_xml_path(str(assets / "exo.xml"))
    as_drawn = mujoco.MjData(drawn)
    mujoco.mj_forward(drawn, as_drawn)
    np.testing.assert_allclose(data.ten_length, as_drawn.ten_length, atol=1e-9)


def test_moment_arms_stay_positive_over_the_whole_range(assets):
    model = build(assets / "exo.xml", Person(), 34.0, Ankle())
    data = mujoco.MjData(model)
    for name in ("hip_l", "knee_l", "hip_r", "knee_r"):
        joint = model.joint(name)
        for angle in np.linspace(joint.range[0], joint.range[1], 30):
            data.qpos[:] = model.qpos0
            data.qpos[joint.qposadr] = angle
            mujoco.mj_forward(model, data)
            row = moment_row(model, data, model.actuator(name).id)
            assert row[joint.dofadr[0]] > 0.015
            assert np.abs(np.delete(row, joint.dofadr[0])).max() < 1e-9


def test_only_feet_touch_and_only_the_floor(assets):
    model = build(assets / "exo.xml", Person(), 34.0, Ankle())
    solid = {model.geom(i).name for i in range(model.ngeom) if model.geom_contype[i] or model.geom_conaffinity[i]}
    assert solid == {"floor", "heel_l", "toe_l", "heel_r", "toe_r"}


def test_the_ankle_is_a_setting(assets):
    for mode, stiffness in (("free", 0.0), ("sprung", 60.0), ("powered", 0.0)):
        model = build(assets / "exo.xml", Person(), 0.0, Ankle(mode, 60.0))
        assert model.joint("ankle_r").stiffness[0] == stiffness


def test_what_cannot_be_is_one_line(assets, tmp_path):
    with pytest.raises(ScenarioError, match="0 to 45 kg"):
        build(assets / "exo.xml", Person(), 46.0, Ankle())
    with pytest.raises(ScenarioError, match=r"1\.4 to 2\.1 m"):
        Person(2.5)
    with pytest.raises(ModelError, match="no such file"):
        build(tmp_path / "none.xml", Person(), 0.0, Ankle())
    broken = tmp_path / "broken.xml"
    broken.write_text("<mujoco><worldbody><body></mujoco>")
    with pytest.raises(ModelError, match="cannot read"):
        build(broken, Person(), 0.0, Ankle())
    with pytest.raises(ModelError, match=r"bench\.xml: carries no person: walking and sizing need a worn machine"):
        build(assets / "bench.xml", Person(), 0.0, Ankle())
    renamed = tmp_path / "renamed.xml"
    renamed.write_text((assets / "exo.xml").read_text().replace('"torso_x"', '"trunk_x"'))
    with pytest.raises(ModelError, match='joint "torso_x"'):
        build(renamed, Person(), 0.0, Ankle())
    assert len(COORDINATES) == 9


def test_masses_that_the_rig_knows_better_replace_the_files(assets):
    plain = build(assets / "exo.xml", Person(), 10.0, Ankle())
    model = build(assets / "exo.xml", Person(), 10.0, Ankle(), {"thigh_l": 5.6, "payload": 3.0})
    assert model.body("thigh_l").mass[0] == 5.6
    np.testing.assert_allclose(model.body("thigh_l").inertia, 2 * plain.body("thigh_l").inertia)
    assert model.body_subtreemass[model.body("torso").id] == pytest.approx(32.8)
    with pytest.raises(ModelError, match='did you mean "thigh_l"'):
        build(assets / "exo.xml", Person(), 10.0, Ankle(), {"tigh_l": 1.0})
