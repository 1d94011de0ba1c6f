"""A machine behind pressure regulators, which no valve of its rig commands: its forces are judged, and its gas is not."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import exo_sim as exo
from exo_sim.recording.table import Recording

MASS, STIFFNESS, FRICTION, ATMOSPHERE = 6.0, 2500.0, 22.0, 101325.0
AREA_1, AREA_2 = 0.25 * math.pi * 0.032**2, 0.25 * math.pi * (0.032**2 - 0.012**2)
MJCF = f"""<mujoco><option gravity="0 0 0" timestep="0.001"/>
<worldbody><body><joint name="slide" type="slide" axis="1 0 0" stiffness="{STIFFNESS}"/><geom size="0.03" mass="{MASS}"/></body></worldbody>
<actuator><motor name="piston" joint="slide"/></actuator></mujoco>"""
RIG = """name = "regulated"
model = "machine.xml"
[cylinders.piston]
actuator = "piston"
bore = "32 mm"
rod = "12 mm"
stroke = "160 mm"
retracted_length = "-80 mm"
dead_volume_1 = "10 cm^3"
dead_volume_2 = "12 cm^3"
"""


def recorded() -> Recording:
    """Return what regulators that follow two sines make of the slide, solved without this package; 1 kPa and 20 um of noise."""
    time, rng = np.arange(0.0, 20.0, 0.002), np.random.default_rng(3)

    def pressures(t: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        swing = 0.6e5 * np.sin(3.1 * t) + 0.5e5 * np.sin(7.3 * t)
        return np.asarray(4e5 + swing), np.asarray(4.3e5 - swing)

    def rates(t: float, state: np.ndarray) -> list[float]:
        p_1, p_2 = pressures(t)
        drive = p_1 * AREA_1 - p_2 * AREA_2 - ATMOSPHERE * (AREA_1 - AREA_2)
        return [state[1], (float(drive) - STIFFNESS * state[0] - FRICTION * math.tanh(state[1] / 5e-4)) / MASS]

    position = solve_ivp(rates, (0.0, 20.0), [0.0, 0.0], "LSODA", time, rtol=1e-8, atol=1e-9, max_step=0.01).y[0]
    columns = {f"piston.pressure_{side}": p + 1e3 * rng.standard_normal(time.size) for side, p in enumerate(pressures(time), 1)}
    columns["slide.position"] = position + 2e-5 * rng.standard_normal(time.size)
    return Recording("regulated", time, columns, {key: "m" if "position" in key else "Pa" for key in columns})


@pytest.fixture(scope="module")
def recording() -> Recording:
    return recorded()


def machine(folder: Path, more: str = "") -> exo.Rig:
    (folder / "machine.xml").write_text(MJCF)
    (folder / "rig.toml").write_text(RIG + more)
    return exo.Rig.load(folder / "rig.toml")


def test_its_friction_is_found_and_its_gas_is_an_open_question(recording: Recording, tmp_path: Path) -> None:
    found = exo.diagnose(recording, machine(tmp_path))
    assert [one.name for one in found.findings if one.kind != "calibration"] == ["coulomb_friction"]
    force = found.findings[0].parameters["force"]
    assert force.low < FRICTION < force.high and force.value == pytest.approx(FRICTION, rel=0.05)
    assert any("the gas of piston" in question.question for question in found.result.open_questions)
    assert found.result.free_run == {}
    assert 'coulomb_friction' in found.result.improved


def test_where_its_forces_agree_it_is_as_its_rig(recording: Recording, tmp_path: Path) -> None:
    known = machine(tmp_path, f'[effects.coulomb_friction.piston]\nforce = "{FRICTION} N"\n')
    assert exo.diagnose(recording, known).verdict in ("consistent", "calibration")
    replayed = exo.compare(recording, known)
    error = np.asarray(replayed.windowed["slide.position"]) - recording["slide.position"]
    assert math.sqrt(np.mean(error**2)) < 2e-4 < 0.02 * np.ptp(recording["slide.position"])
    assert not any("pressure" in key for key in replayed.windowed.columns)
