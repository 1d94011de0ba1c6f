"""A bench that has been started with a rig, and moved along; every effect that it can have at once."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.rig_model import load
from exo_sim.rig import parse
from exo_sim.simulation.plugin import PneumaticPlugin

EVERYTHING = """
[effects.wall_heat_transfer.piston]
conductance = "0.8 W/K"
[effects.moving_wall_temperature.piston]
heat_capacity = "20 J/K"
outside_conductance = "0.1 W/K"
[effects.piston_leakage.piston]
area = "0.02 mm^2"
[effects.external_leakage.piston]
area_1 = "0.02 mm^2"
laminar_2 = "1e-17 kg/(s Pa^2)"
inertial = "1e18 Pa^2 s^2/kg^2"
[effects.valve_null_leakage.piston]
area = "0.05 mm^2"
[effects.valve_deadband.piston]
width = 0.03
[effects.valve_offset.piston]
shift = 0.01
[effects.valve_lag.piston]
time_constant = "5 ms"
delay = "3.3 ms"
[effects.valve_hysteresis.piston]
width = 0.02
[effects.spool_rate_limit.piston]
rate = "100 1/s"
[effects.critical_ratio.piston]
ratio = 0.3
[effects.line_restriction.piston]
area = "8 mm^2"
volume = "10 cm^3"
[effects.exhaust_back_pressure.exhaust]
area = "10 mm^2"
[effects.supply_droop.supply]
volume = "1 L"
conductance = "1e-7 kg/(s Pa)"
[effects.supply_regulator.supply]
droop = "1e7 Pa s/kg"
time_constant = "0.05 s"
hysteresis = "5000 Pa"
[effects.end_cushioning.piston]
length = "10 mm"
area = "0.3 mm^2"
[effects.asymmetric_friction.piston]
forward = "12 N"
backward = "11 N"
[effects.stribeck_friction.piston]
breakaway = "15 N"
velocity = "0.02 m/s"
[effects.viscous_friction.piston]
coefficient = "40 N s/m"
[effects.pressure_dependent_friction.piston]
coefficient = "1e-5 m^2"
[effects.quadratic_drag.piston]
coefficient = "20 N s^2/m^2"
[effects.return_spring.piston]
stiffness = "200 N/m"
rest = "0.08 m"
[effects.presliding.piston]
stiffness = "2e5 N/m"
damping = "100 N s/m"
[effects.transmission_compliance.piston]
stiffness = "1e6 N/m"
[effects.backlash.piston]
gap = "0.2 mm"
[effects.coulomb_friction.slide]
force = "2 N"
[effects.unknown.piston]
acts = "flow_2"
depends_on = "position"
at = ["0 m", "80 mm", "160 mm"]
values = ["0 kg/s", "1e-5 kg/s", "-1e-5 kg/s"]
"""


def start(path: Path, extra: str = "", x: float = 0.08) -> tuple[mujoco.MjModel, mujoco.MjData, PneumaticPlugin]:
    rig = parse(path.read_text() + extra, path)
    model = load(rig)
    data = mujoco.MjData(model)
    data.qpos[0] = x
    plugin = PneumaticPlugin(model, rig)
    plugin.reset(data, 3e5, 3.3e5)
    return model, data, plugin


def go(data: mujoco.MjData, plugin: PneumaticPlugin, steps: int) -> NDArray[np.float64]:
    out = []
    for _ in range(steps):
        plugin.command[:] = 0.3 * np.sin(2 * np.pi * data.time + np.arange(len(plugin.command)))
        plugin.step(data)
        out.append(np.concatenate([data.qpos, data.qvel, plugin.pressures().ravel(), plugin.force]))
    return np.array(out)
