"""Designs: closed-form linkages against MuJoCo, the space's variables, and the rig that comes of them."""

import mujoco
import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import ModelError, RigError
from exo_sim.machine.linkage import check_strokes, moment_row
from exo_sim.machine.load import load
from exo_sim.sizing.design import actuator_mass, fit, fitted
from exo_sim.sizing.linkage_geometry import length_and_arm
from exo_sim.sizing.screening import chosen_bores
from exo_sim.sizing.study import space_of
from exo_sim.sizing.writing import sized_text


def _chosen(exo, space, loads, **changed):
    numbers = {**space.owners(exo), **changed}
    return space.design(numbers, chosen_bores(exo, space, (loads,), numbers))


def test_closed_form_linkage_is_mujocos(exo, space):
    model = load(exo)
    data = mujoco.MjData(model)
    for kind in space.kinds:
        for angle in np.linspace(kind.range[0], kind.range[1], 7):
            data.joint(kind.joints[1]).qpos[0] = angle
            mujoco.mj_forward(model, data)
            index = model.actuator(kind.cylinders[1]).id
            length, arm = length_and_arm(kind.own, kind.across, np.array([angle]))
            assert length[0] == pytest.approx(data.actuator_length[index], rel=1e-12)
            dof = int(model.joint(kind.joints[1]).dofadr[0])
            assert arm[0] == pytest.approx(moment_row(model, data, index)[dof], rel=1e-9)


def test_only_the_angle_between_the_ends_counts(exo, space):
    """Turning both ends together changes neither length nor arm, so three variables are enough."""
    kind = space.kinds[0]
    turned = [np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]]) @ end for end in (kind.own.base, kind.own.rod)]
    angles = np.linspace(kind.range[0], kind.range[1], 9)
    moved = rigs.Attachment(tuple(turned[0]), tuple(turned[1]))
    np.testing.assert_allclose(length_and_arm(kind.own, 0.0, angles), length_and_arm(moved, 0.0, angles), rtol=1e-12)


def test_the_owners_geometry_is_in_the_space(exo, space):
    numbers = space.owners(exo)
    for kind in space.kinds:
        points = space.attachment(kind, numbers)
        np.testing.assert_allclose([*points.base, *points.rod], [*kind.own.base, *kind.own.rod], atol=6e-5)


def test_sized_rig_reads_back_and_fits_its_machine(exo, space, loads, tmp_path):
    design = _chosen(exo, space, loads, **{"hip.turn": 0.1, "knee.to": 0.08})
    (tmp_path / "sized.toml").write_text(sized_text(exo, space.kinds, design, tmp_path), encoding="utf-8")
    back = rigs.read(tmp_path / "sized.toml")
    wanted = fitted(exo, space.kinds, design)
    assert back.supply.pressure == pytest.approx(wanted.supply.pressure)
    for name, cylinder in wanted.cylinders.items():
        other = back.cylinders[name]
        for key in ("bore", "rod", "stroke", "retracted_length", "dead_volume_1", "dead_volume_2", "valve_area"):
            assert getattr(other, key) == pytest.approx(getattr(cylinder, key), rel=1e-6), key
        assert other.attachment is not None and cylinder.attachment is not None
        assert other.attachment.base == pytest.approx(cylinder.attachment.base)
        assert other.attachment.rod == pytest.approx(cylinder.attachment.rod)
    check_strokes(back, load(back))
    assert back.ankle == exo.ankle and "# 250 psi" not in back.name


def test_mass_is_the_catalogues(exo, space, loads):
    design = _chosen(exo, space, loads)
    masses = [2 * design.joints[k.name].cylinder.mass(fit(k, design.joints[k.name]).stroke) for k in space.kinds]
    assert actuator_mass(space.kinds, design) == pytest.approx(sum(masses))


def test_a_bench_is_refused_in_one_line(repository):
    with pytest.raises((RigError, ModelError)) as error:
        space_of(rigs.read(repository / "assets" / "bench.toml"), 0.04, None)
    assert "\n" not in str(error.value)


def test_a_pressure_limit_that_leaves_nothing(exo):
    with pytest.raises(RigError, match="leaves nothing"):
        space_of(exo, 0.04, 2e5)
