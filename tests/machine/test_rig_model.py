"""What a rig knows of a joint better than the MJCF: a pendulum's swing, and names that are no joints."""

from __future__ import annotations

from pathlib import Path

import benches
import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.errors import ModelError
from exo_sim.machine.rig_model import corrected, load
from exo_sim.rig import JointFactors

PENDULUM = """
<mujoco><option timestep="1e-4" integrator="RK4"/><worldbody><body name="arm"><joint name="arm" type="hinge" axis="0 1 0" damping="0.01"/>
<inertial pos="0 0 -0.3" mass="2" diaginertia="0.01 0.01 0.001"/></body></worldbody></mujoco>
"""


def at_rest_but(angle: float, model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qpos[0] = angle
    mujoco.mj_forward(model, data)
    return data


@given(inertia=st.floats(0.5, 2.0), angle=st.floats(0.1, 1.5))
def test_an_inertia_factor_slows_a_pendulum_and_leaves_its_weight(inertia: float, angle: float) -> None:
    plain, heavier = (mujoco.MjModel.from_xml_string(PENDULUM) for _ in range(2))
    corrected(heavier, {"arm": JointFactors(inertia=inertia)}, "rig.toml")
    one, other = at_rest_but(angle, plain), at_rest_but(angle, heavier)
    assert other.qacc[0] == pytest.approx(one.qacc[0] / inertia, rel=1e-9)
    assert other.qfrc_bias[0] == one.qfrc_bias[0]
    assert heavier.dof_damping[0] == plain.dof_damping[0]
    assert heavier.dof_M0[0] == pytest.approx(inertia * plain.dof_M0[0])


def test_a_joint_that_is_none_is_refused() -> None:
    model = mujoco.MjModel.from_xml_string(PENDULUM)
    with pytest.raises(ModelError, match=r"rig\.toml: joints\.amr is not a joint of the model; did you mean .arm"):
        corrected(model, {"amr": JointFactors(damping=0.5)}, "rig.toml")


def test_a_rig_file_says_so(repository: Path, tmp_path: Path) -> None:
    from exo_sim.rig import read

    text = (repository / "assets" / "bench.toml").read_text()
    (tmp_path / "bench.xml").write_text((repository / "assets" / "bench.xml").read_text())
    (tmp_path / "plain.toml").write_text(text)
    (tmp_path / "heavy.toml").write_text(text + '\n[joints.slide]\ninertia_factor = 1.25\n')
    plain, heavy = (load(read(tmp_path / f"{name}.toml")) for name in ("plain", "heavy"))
    np.testing.assert_allclose(heavy.dof_M0, 1.25 * plain.dof_M0)
    np.testing.assert_array_equal(heavy.body_mass, plain.body_mass)


def test_an_effect_on_a_joint_that_the_model_lacks_is_refused_where_the_model_is_loaded(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path, '[effects.coulomb_friction.pistom]\nforce = "5 N"\n')
    with pytest.raises(ModelError, match=r'\[effects\.coulomb_friction\.pistom\]: bench\.xml has no joint "pistom"; did you mean "piston"'):
        load(rig)


def test_a_machine_that_is_lighter_than_its_mjcf_is_simulated(repository: Path, tmp_path: Path) -> None:
    from exo_sim.rig import read
    from exo_sim.simulation.plugin import PneumaticPlugin

    text = (repository / "assets" / "bench.toml").read_text()
    (tmp_path / "bench.xml").write_text((repository / "assets" / "bench.xml").read_text())
    (tmp_path / "light.toml").write_text(text + '\n[joints.slide]\ninertia_factor = 0.98\n')
    rig = read(tmp_path / "light.toml")
    model = load(rig)
    assert model.dof_armature[0] < 0.0 < model.dof_M0[0]
    PneumaticPlugin(model, rig)
    with pytest.raises(ModelError, match="armature"):
        PneumaticPlugin(model, read(repository / "assets" / "bench.toml"))


def test_stops_are_set_inside_those_of_the_mjcf() -> None:
    limited = PENDULUM.replace('damping="0.01"', 'damping="0.01" limited="true" range="-90 90"')
    model = mujoco.MjModel.from_xml_string(limited)
    corrected(model, {"arm": JointFactors(range=(-0.2, 0.5))}, "rig.toml")
    assert model.jnt_range[0] == pytest.approx([-0.2, 0.5])
    with pytest.raises(ModelError, match=r"joints\.arm\.range = -3 to 0\.5 goes beyond"):
        corrected(model, {"arm": JointFactors(range=(-3.0, 0.5))}, "rig.toml")
    free = mujoco.MjModel.from_xml_string(PENDULUM)
    corrected(free, {"arm": JointFactors(range=(-0.2, 0.5))}, "rig.toml")
    assert free.jnt_limited[0]
