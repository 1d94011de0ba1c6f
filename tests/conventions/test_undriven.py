"""A machine that nothing drives needs no column that says so: absent means none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import exo_sim as exo
from exo_sim.conventions.answerable import questions
from exo_sim.conventions.undriven import drives, is_undriven
from exo_sim.machine.rig_model import load
from exo_sim.recording.table import Recording

LENGTH, GRAVITY, MASS = 0.9, 9.81, 0.5
VISCOUS = 0.02  # N m s/rad

MJCF = f"""<mujoco><compiler angle="radian"/><option gravity="0 0 -{GRAVITY}"/>
<worldbody><body name="bob"><joint name="string" type="hinge" axis="0 -1 0"/>
<inertial pos="0 0 -{LENGTH}" mass="{MASS}" diaginertia="1e-5 1e-5 1e-5"/></body></worldbody></mujoco>
"""


@pytest.fixture
def rig(tmp_path: Path) -> exo.Rig:
    (tmp_path / "machine.xml").write_text(MJCF)
    (tmp_path / "rig.toml").write_text('name = "pendulum"\nmodel = "machine.xml"\n')
    return exo.Rig.load(tmp_path / "rig.toml")


def swing(**columns: np.ndarray) -> Recording:
    """Return a swing that is let go at 0.5 rad and loses its energy in air, as an encoder has it at 100 Hz."""
    inertia, time = MASS * LENGTH**2 + 1e-5, np.arange(0.0, 25.0, 0.01)

    def rates(_: float, state: np.ndarray) -> list[float]:
        return [state[1], (-MASS * GRAVITY * LENGTH * np.sin(state[0]) - VISCOUS * state[1]) / inertia]

    angle = solve_ivp(rates, (0.0, 25.0), [0.5, 0.0], t_eval=time, rtol=1e-9, atol=1e-10).y[0]
    noisy = angle + 5e-5 * np.random.default_rng(3).standard_normal(time.size)
    units = {"string.position": "rad", **dict.fromkeys(columns, "N*m")}
    return Recording("swing", time, {"string.position": noisy, **columns}, units)


def test_a_pendulum_that_is_let_go_is_undriven_and_can_be_asked(rig: exo.Rig) -> None:
    table = swing()
    assert is_undriven(table, rig)
    assert is_undriven(swing(**{"string.external_force": np.zeros(2500)}), rig)
    assert not is_undriven(swing(**{"string.external_force": np.full(2500, 0.1)}), rig)


@pytest.mark.parametrize(("force", "acts"), [([0.0, 0.0], False), ([0.0, np.nan], False), ([0.3, 0.3], True), ([0.0, -0.1], True)])
def test_a_force_that_is_zero_throughout_drives_nothing(force: list[float], acts: bool) -> None:
    assert drives(np.array(force)) is acts


def test_a_machine_with_a_cylinder_is_not_undriven() -> None:
    assert not is_undriven(swing(), exo.Rig.included("bench"))


def test_its_friction_can_be_asked(rig: exo.Rig) -> None:
    asked = {(one.effect, one.where): one for one in questions(swing(), rig, load(rig))}
    assert asked["viscous_friction", "string"].answerable


def test_its_friction_is_found_as_with_a_column_of_zeros(rig: exo.Rig) -> None:
    bare = exo.diagnose(swing(), rig)
    (found,) = [one for one in bare.findings if one.name == "viscous_friction"]
    assert found.where == "string"
    assert found.parameters["coefficient"].value == pytest.approx(VISCOUS, rel=0.05)
    told = exo.diagnose(swing(**{"string.external_force": np.zeros(2500)}), rig)
    assert [one.name for one in told.findings] == [one.name for one in bare.findings]
