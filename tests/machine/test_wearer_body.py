"""The wearer as bodies: masses after Winter, a ground of known stiffness under the soles, nothing else that touches."""

import mujoco
import numpy as np
import pytest

from exo_sim.machine import anthropometry, sole_contact, wearer_body
from exo_sim.machine.person import SEGMENTS, Person, poses_along
from exo_sim.machine.worn_model import build
from exo_sim.rig import Ankle


@pytest.fixture(scope="module", params=[(1.70, 75.0), (1.90, 95.0)], ids=["usual", "tall"])
def person(request):
    return Person(*request.param)


def test_segments_have_the_mass_and_inertia_of_the_tables(person):
    model = wearer_body.alone(person)
    assert model.body_mass.sum() == pytest.approx(anthropometry.body(person).mass.sum())
    where, rng = wearer_body.find(model), np.random.default_rng(1)
    data = mujoco.MjData(model)
    q, v = rng.normal(0.0, 0.3, 9), rng.normal(0.0, 1.0, 9)
    data.qpos[where.dofs[:9]], data.qvel[where.dofs[:9]] = q, v
    mujoco.mj_forward(model, data)
    mujoco.mj_energyPos(model, data)
    mujoco.mj_energyVel(model, data)
    model.jnt_stiffness[:] = 0.0
    # toes at zero move with the foot: both together are the foot of the tables
    expected = anthropometry.energy(poses_along(q[None], v[None], person), person)[0]
    assert data.energy.sum() == pytest.approx(expected, rel=1e-6)


def test_a_pack_is_on_the_trunk(person):
    pack = wearer_body.Pack(20.0, (-0.18, 0.33), 0.02)
    model = wearer_body.alone(person, pack)
    assert model.body_mass.sum() == pytest.approx(person.mass + 20.0)
    assert model.body_parentid[model.body("pack").id] == model.body("person_torso").id


def test_the_ground_gives_like_a_spring_of_known_stiffness(person):
    model = wearer_body.alone(person)
    where = wearer_body.find(model)
    data, still = mujoco.MjData(model), where.dofs[2:]
    model.dof_damping[still] = 1e5
    for _ in range(4000):
        mujoco.mj_step(model, data)
    assert data.ncon == 8 and set(data.contact.geom.ravel()) == {0, *where.geoms.ravel()}
    force, total = np.zeros(6), 0.0
    for i in range(data.ncon):
        mujoco.mj_contactForce(model, data, i, force)
        total += force[0]
        named = model.geom(int(data.contact[i].geom.max())).name.split("_")[1]
        depth = np.array(-data.contact[i].dist)
        assert force[0] == pytest.approx(wearer_body.POINTS[named] * float(sole_contact.force_at(depth)), rel=0.02)
    assert total == pytest.approx(9.81 * person.mass, rel=1e-3)
    sensed = [-data.sensordata[first + 2] for first in where.ground]
    assert sum(sensed) == pytest.approx(total, rel=1e-3)


def test_beside_a_machine_its_joints_stay_first_and_nothing_else_touches(repository):
    person = Person()
    bare, both = (build(repository / "assets" / "exo.xml", person, 34.0, Ankle(), embodied=flag) for flag in (False, True))
    assert [both.joint(i).name for i in range(bare.njnt)] == [bare.joint(i).name for i in range(bare.njnt)]
    assert both.nmocap == 0 and both.nv == bare.nv + len(wearer_body.JOINTS)
    assert both.body_mass.sum() == pytest.approx(bare.body_mass.sum() + person.mass)
    touching = {both.geom(i).name for i in range(both.ngeom) if both.geom_contype[i]}
    assert touching == {f"{prefix}{part}_{side}" for side in "lr" for prefix, part in (
        ("", "heel"), ("", "toe"), *(("wearer_", point) for point in wearer_body.POINTS))}  # fmt: skip
    assert {f"person_{name}" for name in SEGMENTS} <= {both.body(i).name for i in range(both.nbody)}
