"""The balance of forces that rigs of real machines are held against, on motion whose force is known."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from exo_sim.recording import Recording
from exo_sim.trials.real.balance import Machine, balance_error, outside_force, read_machine, rows
from exo_sim.trials.real.case import Moving

MODEL = """<mujoco><option gravity="0 0 -9.81"/><worldbody><body name="carriage">
<joint name="slide" type="slide" axis="{axis}"/><geom type="box" size="1 1 1" mass="2"/></body></worldbody></mujoco>"""
RIG = """name = "bench"
model = "bench.xml"
[environment]
pressure = "100000 Pa"
[cylinders.piston]
bore = "20 mm"
rod = "10 mm"
acting = "{acting}"
"""
SLOW = Moving(cut_off=10.0, speed=1e-3)
AREA_1 = np.pi * 0.01**2
AREA_2 = AREA_1 - np.pi * 0.005**2


def machine_with(folder: Path, effects: str = "", acting: str = "double", axis: str = "1 0 0") -> Machine:
    (folder / "bench.xml").write_text(MODEL.format(axis=axis))
    (folder / "rig.toml").write_text(RIG.format(acting=acting) + effects)
    return read_machine(folder / "rig.toml")


def swinging(force: Callable[..., NDArray[np.float64]]) -> Recording:
    """A slide moved as a slow sine under 3 and 2 bar, with the outside force that `force(x, v, a)` demands."""
    time = np.arange(0, 20, 0.01)
    x, v, a = 0.05 * np.sin(time), 0.05 * np.cos(time), -0.05 * np.sin(time)
    columns = {"slide.position": x, "piston.pressure_1": np.full_like(x, 3e5), "piston.pressure_2": np.full_like(x, 2e5),
               "slide.external_force": force(x, v, a)}  # fmt: skip
    return Recording("swing", time, columns, dict.fromkeys(columns, ""))


def plain(x, v, a):
    return 2.0 * a - 2e5 * AREA_1 + 1e5 * AREA_2


EFFECTS = {
    '[effects.coulomb_friction.piston]\nforce = "5 N"': lambda x, v: 5 * np.sign(v),
    '[effects.viscous_friction.slide]\ncoefficient = "40 N*s/m"': lambda x, v: 40 * v,
    '[effects.pressure_dependent_friction.piston]\ncoefficient = "10 mm^2"': lambda x, v: 3 * np.sign(v),
    '[effects.quadratic_drag.piston]\ncoefficient = "900 N*s^2/m^2"': lambda x, v: 900 * v * abs(v),
    '[effects.return_spring.piston]\nstiffness = "300 N/m"\nrest = "10 mm"': lambda x, v: 300 * (x - 0.01),
    '[effects.asymmetric_friction.piston]\nforward = "7 N"\nbackward = "4 N"': lambda x, v: np.where(v > 0, 7, -4),
    '[effects.coulomb_friction.piston]\nforce = "5 N"\n[effects.stribeck_friction.piston]\nbreakaway = "9 N"\nvelocity = "20 mm/s"':
        lambda x, v: np.sign(v) * (5 + 4 * np.exp(-((v / 0.02) ** 2))),
    '[effects.unknown.piston]\nacts = "force"\ndepends_on = "velocity"\nat = ["-0.1 m/s", "0.1 m/s"]\nvalues = ["3 N", "-3 N"]':
        lambda x, v: 30 * v,
    '[effects.sensor_bias."slide.external_force"]\nvalue = "2 N"': lambda x, v: 2.0,
}  # fmt: skip


@pytest.mark.parametrize("effect", EFFECTS)
def test_each_law_is_the_contracts(tmp_path: Path, effect: str) -> None:
    recording = swinging(lambda x, v, a: plain(x, v, a) + EFFECTS[effect](x, v))
    force = recording["slide.external_force"]
    assert balance_error(machine_with(tmp_path, effect), (recording,), SLOW) < 0.02 * np.std(force - plain(*_motion(recording))) + 0.02
    assert balance_error(machine_with(tmp_path), (recording,), SLOW) > 0.5


def _motion(recording: Recording) -> tuple[NDArray[np.float64], ...]:
    t = recording.time
    return 0.05 * np.sin(t), 0.05 * np.cos(t), -0.05 * np.sin(t)


def test_gravity_a_single_chamber_and_a_late_sensor(tmp_path: Path) -> None:
    machine = machine_with(tmp_path, acting="single", axis="0 0 1")
    recording = swinging(lambda x, v, a: 2.0 * a + 2 * 9.81 - 2e5 * AREA_1)
    assert balance_error(machine, (recording,), SLOW) < 0.01
    late = Recording("late", recording.time, {**recording.columns, "slide.position": 0.05 * np.sin(recording.time - 0.2)}, {})
    known = machine_with(tmp_path, '[effects.sensor_delay."slide.position"]\nseconds = "200 ms"', acting="single", axis="0 0 1")
    there, shifted = rows(recording, SLOW, machine), rows(late, SLOW, known)
    assert np.median(np.abs(shifted.position[: len(there.position)] - there.position[: len(shifted.position)])) < 2e-3


def test_a_stiff_bristle_settles_within_its_length(tmp_path: Path) -> None:
    effects = '[effects.coulomb_friction.piston]\nforce = "5 N"\n[effects.presliding.piston]\nstiffness = "5000 N/m"'
    with_bristles, without = machine_with(tmp_path, effects), machine_with(tmp_path, effects.split("[effects.presliding")[0])
    at = rows(swinging(plain), SLOW, without)
    far = at.travelled > 0.02
    assert np.allclose(outside_force(with_bristles, at)[far], outside_force(without, at)[far], atol=1e-6)
    near = at.travelled < 1e-4
    assert np.all(np.abs(outside_force(with_bristles, at) - outside_force(without, at))[near] > 5.0)


def test_effects_that_it_does_not_know_are_said(tmp_path: Path) -> None:
    effects = '[effects.friction_that_dreams.piston]\nforce = "5 N"\n[effects.valve_lag.piston]\ntime_constant = "1 ms"'
    machine = machine_with(tmp_path, effects)
    assert machine.left_out == ("friction_that_dreams",)
