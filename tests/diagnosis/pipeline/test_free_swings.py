"""A swing that nothing drives, filmed: what the noise of the position hides from the forces, one run still shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import exo_sim as exo
from exo_sim.recording.filters import first_rate_gain, smoothed
from exo_sim.recording.table import Recording

LENGTH, GRAVITY, NOISE = 1.45, 9.81, 1e-3
TIME = np.arange(0.0, 40.0, 1.0 / 30.0)
MJCF = f"""<mujoco><compiler angle="radian"/><option gravity="0 0 -{GRAVITY}"/>
<worldbody><body name="bob"><joint name="string" type="hinge" axis="0 -1 0"/>
<inertial pos="0 0 -{LENGTH}" mass="0.2" diaginertia="1e-6 1e-6 1e-6"/></body></worldbody></mujoco>
"""


def filmed(length: float, noise: float = NOISE, damping: float = 0.0) -> Recording:
    """Return a swing of a bob on a string, 30 frames a second; `damping` [1/s] takes its speed."""

    def changes(_: float, state: list[float]) -> list[float]:
        return [state[1], -GRAVITY / length * np.sin(state[0]) - damping * state[1]]

    swing = solve_ivp(changes, (0.0, 40.0), [0.3, 0.0], t_eval=TIME, rtol=1e-9, atol=1e-10)
    angle = swing.y[0] + noise * np.random.default_rng(3).standard_normal(TIME.size)
    return Recording("swing", TIME, {"string.position": angle}, {"string.position": "rad"})


@pytest.fixture
def rig(tmp_path: Path) -> exo.Rig:
    (tmp_path / "machine.xml").write_text(MJCF)
    (tmp_path / "rig.toml").write_text('name = "pendulum"\nmodel = "machine.xml"\n')
    return exo.Rig.load(tmp_path / "rig.toml")


@pytest.mark.parametrize("length", [1.02, 1.2])
def test_the_period_of_a_swing_says_its_inertia(rig: exo.Rig, length: float) -> None:
    found = exo.diagnose(filmed(length * LENGTH), rig)
    assert found.verdict == "calibration"
    (only,) = found.findings
    factor = only.parameters["factor"]
    assert only.name == "joint_inertia"
    assert factor.low < length < factor.high  # gravity's moment goes with the length, inertia with its square
    assert found.result.free_run["string.position"].after < 10.0 * NOISE


def test_an_inertia_that_noise_hides_in_part_does_not_settle_why_a_swing_strays(rig: exo.Rig) -> None:
    found = exo.diagnose(filmed(1.2 * LENGTH, 4.0 * NOISE), rig)
    assert [one.name for one in found.findings] == ["joint_inertia"]
    assert found.verdict == "undetermined"
    assert any(one.question == "what makes string swing otherwise than the rig" for one in found.result.open_questions)


@pytest.mark.parametrize("noise", [NOISE, 4.0 * NOISE])
def test_a_swing_as_its_rig_has_it_strays_by_no_more_than_its_noise(rig: exo.Rig, noise: float) -> None:
    found = exo.diagnose(filmed(LENGTH, noise), rig)
    assert found.verdict == "consistent"
    assert found.result.free_run["string.position"].after < 2.0 * noise


def test_a_filmed_swing_keeps_its_friction(rig: exo.Rig) -> None:
    found = exo.diagnose(filmed(LENGTH, damping=0.05), rig)
    assert found.verdict == "mismatch"
    (only,) = found.findings
    assert only.name == "viscous_friction"
    said = only.parameters["coefficient"]
    assert said.low < 0.05 * 0.2 * LENGTH**2 < said.high
    assert said.value == pytest.approx(0.05 * 0.2 * LENGTH**2, rel=0.1)
    run = found.result.free_run["string.position"]
    assert run.after < 0.1 * run.before


def test_friction_that_the_forces_hardly_show_is_not_passed_over(rig: exo.Rig) -> None:
    assert exo.diagnose(filmed(LENGTH, damping=0.02), rig).verdict != "consistent"


@pytest.mark.parametrize(("length", "verdict"), [(LENGTH, "consistent"), (1.02 * LENGTH, "undetermined")])
def test_a_swing_that_strays_from_its_rig_is_not_consistent_with_it(rig: exo.Rig, length: float, verdict: str) -> None:
    found = exo.diagnose(filmed(length, 4.0 * NOISE), rig)
    assert found.verdict == verdict
    assert found.findings == ()
    asked = [one for one in found.result.open_questions if one.question == "what makes string swing otherwise than the rig"]
    assert len(asked) == (verdict == "undetermined")
    assert all("less noise" in one.do for one in asked)


def test_a_recording_of_another_joint_alone_is_no_error(tmp_path: Path) -> None:
    second = '<body name="other" pos="0 1 0"><joint name="chain" type="hinge" axis="0 -1 0"/>'
    two = MJCF.replace("</worldbody>", f'{second}<inertial pos="0 0 -1" mass="0.2" diaginertia="1e-6 1e-6 1e-6"/></body></worldbody>')
    (tmp_path / "machine.xml").write_text(two)
    (tmp_path / "rig.toml").write_text('name = "pendulums"\nmodel = "machine.xml"\n')
    string, chain = filmed(1.02 * LENGTH)["string.position"], filmed(1.0)["string.position"]
    columns = {"string.position": string, "chain.position": chain}
    both = Recording("both", TIME, columns, dict.fromkeys(columns, "rad"))
    alone = Recording("alone", TIME, {"chain.position": chain}, {"chain.position": "rad"})
    found = exo.diagnose([both, alone], exo.Rig.load(tmp_path / "rig.toml"))
    assert any(one.question == "what makes string swing otherwise than the rig" for one in found.result.open_questions)


def test_the_first_rate_of_a_filter_is_as_noisy_as_it_is_said_to_be() -> None:
    time, rng = np.arange(200, dtype=np.float64) * 0.01, np.random.default_rng(1)
    rates = [smoothed(time, rng.standard_normal(time.size))[1][0] for _ in range(400)]
    assert np.std(rates) == pytest.approx(first_rate_gain(time), rel=0.1)
