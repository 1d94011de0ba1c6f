"""What changes slowly is judged at any rate of the logger: the leak of a vessel over minutes, the friction of a slide that creeps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import exo_sim as exo
from exo_sim.recording.table import Recording

MJCF = """<mujoco>
<worldbody><body><joint name="slide" type="slide" axis="1 0 0" range="0 0.05"/><geom size="0.01" mass="1"/></body></worldbody>
<actuator><motor name="chamber" joint="slide"/></actuator></mujoco>"""
RIG = """name = "vessel"
model = "machine.xml"
[cylinders.chamber]
actuator = "chamber"
bore = "25 mm"
rod = "0 mm"
stroke = "50 mm"
dead_volume_1 = "80 cm^3"
dead_volume_2 = "5 cm^3"
acting = "single"
"""
VOLUME, ROOM, NOISE = 80e-6 + 0.25 * np.pi * 0.025**2 * 0.025, 293.15, 200.0
CONDUCTANCE = 6e-18


def decay(period: float, seconds: float, conductance: float = CONDUCTANCE) -> Recording:
    """Return the pressure of a vessel as warm as the room that leaks to the atmosphere through a porous wall, C (p^2 - p_a^2)."""
    time = np.arange(0.0, seconds, period)
    rate = 2.0 * conductance * 287.05 * ROOM / VOLUME * 101325.0  # of artanh(p_a/p), as dp/dt = -C R T/V (p^2 - p_a^2)
    pressure = 101325.0 / np.tanh(np.arctanh(101325.0 / 8.6e5) + 0.5 * rate * time)
    pressure = pressure + NOISE * np.random.default_rng(5).standard_normal(time.size)
    columns = {"chamber.pressure_1": pressure, "slide.position": np.full(time.size, 0.025)}
    return Recording("decay", time, columns, {"chamber.pressure_1": "Pa", "slide.position": "m"})


@pytest.fixture
def rig(tmp_path: Path) -> exo.Rig:
    (tmp_path / "machine.xml").write_text(MJCF)
    (tmp_path / "rig.toml").write_text(RIG)
    return exo.Rig.load(tmp_path / "rig.toml")


@pytest.mark.parametrize("period", [0.6, 2.0])
def test_a_leak_over_minutes_is_found_on_a_slow_logger(rig: exo.Rig, period: float) -> None:
    found = exo.diagnose(decay(period, 600.0), rig)
    (leak,) = found.findings
    assert leak.name == "external_leakage"
    said = leak.parameters["laminar_1"]
    assert said.value == pytest.approx(CONDUCTANCE, rel=0.05)
    assert said.low < CONDUCTANCE < said.high
    run = found.result.free_run["chamber.pressure_1"]
    assert run.after < 0.1 * run.before
    assert run.after < 3.0 * NOISE


def test_a_slide_that_creeps_keeps_its_friction_on_a_slow_logger(tmp_path: Path) -> None:
    (tmp_path / "machine.xml").write_text(
        '<mujoco><worldbody><body><joint name="slide" type="slide" axis="1 0 0"/><geom size="0.01" mass="3"/></body></worldbody></mujoco>'
    )
    (tmp_path / "rig.toml").write_text('name = "slide"\nmodel = "machine.xml"\n')
    time, pulse = np.arange(0.0, 300.0, 0.25), 2.0 * np.pi / 20.0
    speed = 0.1 * pulse * np.cos(pulse * time)
    force = -3.0 * 0.1 * pulse**2 * np.sin(pulse * time) + 5.0 * np.sign(speed) + 60.0 * speed
    columns = {
        "slide.position": 0.1 * np.sin(pulse * time) + 2e-5 * np.random.default_rng(1).standard_normal(time.size),
        "slide.external_force": force + 0.05 * np.random.default_rng(2).standard_normal(time.size),
    }
    table = Recording("creep", time, columns, {"slide.position": "m", "slide.external_force": "N"})
    rig = exo.Rig.load(tmp_path / "rig.toml")
    found = {one.name: one.parameters for one in exo.diagnose(table, rig).findings}
    assert set(found) == {"coulomb_friction", "viscous_friction"}
    assert found["coulomb_friction"]["force"].value == pytest.approx(5.0, rel=0.03)
    assert found["viscous_friction"]["coefficient"].value == pytest.approx(60.0, rel=0.1)
    coarse = Recording("coarse", time[::12], {key: values[::12] for key, values in columns.items()}, table.units)
    again = exo.diagnose(coarse, rig).result
    assert again.verdict == "undetermined"
    assert any("do not show how it moves" in one.why for one in again.open_questions)


def test_a_fall_between_two_samples_of_a_slow_logger_is_not_judged(rig: exo.Rig) -> None:
    found = exo.diagnose(decay(2.0, 600.0, 40.0 * CONDUCTANCE), rig)  # gone within 5 s
    assert found.verdict == "undetermined"
    assert any("do not show what the gas does" in one.why for one in found.result.open_questions)
