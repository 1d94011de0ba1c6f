"""Small machines and recordings of them for the tests of the replay; the motion of a led piston is known in closed form."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim import rig as rigs
from exo_sim.machine.rig_model import load
from exo_sim.recording import Recording
from exo_sim.rig import Rig
from exo_sim.simulation.plugin import PneumaticPlugin

MODEL = """
<mujoco>
  <option timestep="0.001" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody><body name="load">
    <joint name="slide" type="slide" axis="1 0 0"/><geom type="sphere" size="0.05" mass="8" contype="0" conaffinity="0"/>
  </body></worldbody>
  {actuator}
</mujoco>
"""
CYLINDER = """
[supply]
pressure = "7 bar"
[cylinders.piston]
actuator = "piston"
bore = "32 mm"
rod = "12 mm"
stroke = "200 mm"
retracted_length = "-0.1 m"
dead_volume_1 = "12 cm^3"
dead_volume_2 = "15 cm^3"
[cylinders.piston.valve]
area = "2 mm^2"
"""


def bench(folder: Path, more: str = "", cylinder: bool = True) -> Rig:
    """Return a mass on a slide, with a cylinder or none; `more` goes to the end of the rig file."""
    actuator = '<actuator><motor name="piston" joint="slide"/></actuator>' if cylinder else ""
    (folder / "bench.xml").write_text(MODEL.format(actuator=actuator))
    path = folder / "rig.toml"
    path.write_text('name = "bench"\nmodel = "bench.xml"\n' + (CYLINDER if cylinder else "") + more)
    return rigs.read(path)


def renamed(rig: Rig, cylinder: str, name: str) -> Rig:
    """Return a rig whose cylinder has another name; its actuator keeps its own."""
    text = rig.text
    for key in (f"cylinders.{cylinder}", *(f"effects.{effect.name}.{cylinder}" for effect in rig.effects)):
        for end in "].":
            text = text.replace(f"[{key}{end}", f"[{key.removesuffix(cylinder)}{name}{end}")
    rig.path.write_text(text)
    return rigs.read(rig.path)


def lively(time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a command that opens and closes the valve at uneven times."""
    return 0.5 * np.sign(np.sin(9.0 * time)) * (np.sin(2.3 * time) > -0.5) * (time > 0.05)


def recorded(rig: Rig, seconds: float = 3.0, told: Callable[[NDArray[np.float64]], NDArray[np.float64]] = lively) -> Recording:
    """Return what the plug-in makes of a rig, step by step in Python, under a command over time."""
    model = load(rig)
    data, plugin = mujoco.MjData(model), PneumaticPlugin(model, rig)
    plugin.reset(data, 4e5, 4.5e5)
    n = round(seconds / plugin.dt)
    time = np.arange(n) * plugin.dt
    command = told(np.asarray(time, np.float64))
    independent = rig.cylinders["piston"].valve.independent
    other = -0.8 * command * (np.sin(31.0 * time) > -0.3)
    pressure, position = np.empty((n, 2)), np.empty(n)
    for i in range(n):
        mujoco.mj_step1(model, data)
        plugin.advance(data)
        pressure[i], position[i] = plugin.pressures()[0], data.qpos[0]
        plugin.command[:] = command[i]
        if independent:
            plugin.command_2[:] = other[i]
        plugin.compute(data)
        mujoco.mj_step2(model, data)
    commands = {"piston.valve_command_1": command, "piston.valve_command_2": other} if independent else {"piston.valve_command": command}
    return recording(
        time, {**commands, "piston.pressure_1": pressure[:, 0], "piston.pressure_2": pressure[:, 1], "slide.position": position}
    )


def led(rig: Rig, seconds: float = 3.0) -> Recording:
    """Return closed chambers whose piston is led to and fro: p V^k is constant where no heat goes."""
    cylinder = rig.cylinders["piston"]
    time = np.arange(round(seconds * 1000)) / 1000.0
    position = 0.04 * np.sin(2.0 * np.pi * time)
    v_1 = cylinder.dead_volume_1 + cylinder.area_1 * (position + 0.1)
    v_2 = cylinder.dead_volume_2 + cylinder.area_2 * (0.1 - position)
    return recording(
        time,
        {"piston.valve_command": np.zeros_like(time), "piston.pressure_1": 4e5 * (v_1[0] / v_1) ** 1.4,
         "piston.pressure_2": 4.5e5 * (v_2[0] / v_2) ** 1.4, "slide.position": position},
    )  # fmt: skip


def recording(time: np.ndarray, columns: dict[str, np.ndarray]) -> Recording:
    """Return a recording with the units of the contract."""
    units = {"valve_command": "1", "position": "m", "external_force": "N"}
    return Recording("bench", time, columns, {key: units.get(key.split(".")[1], "Pa") for key in columns})
