"""The log of a machine that nobody wears: which signals it has, and a row of them."""

from __future__ import annotations

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.nodes import exhaust_state, supply_state
from exo_sim.physics.state import DRAWN, HELD, INTEGRATED, REMEMBERED, SHARED
from exo_sim.simulation.plugin import PneumaticPlugin
from exo_sim.simulation.wanted_motion import WantedMotion

Array = NDArray[np.float64]

_OF_CYLINDER = (
    ("pressure_1", "Pa"), ("pressure_2", "Pa"), ("temperature_1", "K"), ("temperature_2", "K"),
    ("force", "N"), ("force_demanded", "N"), ("length", "m"), ("gas_used", "kg"),
)  # fmt: skip


class UnwornLog:
    """What is logged of a machine and its motion.

    Args:
        plugin: The cylinders on their model.
        motion: What the joints are to do.

    Attributes:
        units: `"<part>.<signal>"` to its SI unit, in the order of a row.
    """

    def __init__(self, plugin: PneumaticPlugin, motion: WantedMotion) -> None:
        self._plugin, self._motion = plugin, motion
        self.units = self._layout()

    def _layout(self) -> dict[str, str]:
        model, rig, motion = self._plugin.model, self._plugin.rig, self._motion
        out: dict[str, str] = {}
        for j in range(model.njnt):
            name = model.joint(j).name
            if model.jnt_type[j] in (2, 3) and name:
                unit = "rad" if model.jnt_type[j] == 3 else "m"
                out |= {f"{name}.position": unit, f"{name}.velocity": f"{unit}/s"}
        turns = {name: model.joint(name).type[0] == mujoco.mjtJoint.mjJNT_HINGE for name in (*motion.joints, *motion.external)}
        for name in motion.joints:
            out |= {f"{name}.position_demanded": "rad" if turns[name] else "m", f"{name}.torque": "N*m" if turns[name] else "N"}
        out |= {f"{name}.external_force": "N*m" if turns[name] else "N" for name in motion.external}
        for name, cylinder in rig.cylinders.items():
            out |= {f"{name}.{command}": "1" for command in cylinder.commands}
            out |= {f"{name}.{signal}": unit for signal, unit in _OF_CYLINDER}
        return out | {"supply.pressure": "Pa", "exhaust.pressure": "Pa"}

    def write(self, row: Array, k: int, data: mujoco.MjData, made: Array, felt: Array, rods: Array, velocity: Array) -> None:
        """Write one row.

        Args:
            row: Written, shape (len(units),).
            k: Which step of the motion it is.
            data: Of MuJoCo, forces computed.
            made: What the cylinders exert on each degree of freedom [N, N m], shape (nv,).
            felt: Forces from outside [N, N m], in the order of the motion's `external`.
            rods: Rod forces wanted [N]; NaN where valves were commanded instead.
            velocity: Before the step [m/s, rad/s], shape (nv,).
        """
        plugin, motion = self._plugin, self._motion
        model, gas, x = plugin.model, plugin.pneumatics, plugin.lengths
        at = 0
        for j in range(model.njnt):
            if model.jnt_type[j] in (2, 3) and model.joint(j).name:
                row[at], row[at + 1] = data.qpos[model.jnt_qposadr[j]], velocity[model.jnt_dofadr[j]]
                at += 2
        for j, name in enumerate(motion.joints):
            row[at], row[at + 1] = motion.position[k, j], made[model.joint(name).dofadr[0]]
            at += 2
        row[at : at + len(felt)] = felt
        at += len(felt)
        pressures, temperatures = gas.sensed_pressures(x), gas.temperatures()
        n = len(plugin.links)
        for i, link in enumerate(plugin.links):
            drawn = gas.vector[i * INTEGRATED + DRAWN]
            asked = plugin.force[i] if math.isnan(rods[i]) else rods[i]
            for side in range(len(plugin.rig.cylinders[link.cylinder].commands)):
                row[at] = plugin.plant.command[i + side * n]
                at += 1
            row[at : at + len(_OF_CYLINDER)] = (
                *pressures[i], *temperatures[i], plugin.force[i], asked, x[i], drawn,
            )  # fmt: skip
            at += len(_OF_CYLINDER)
        shared = n * INTEGRATED
        held = gas.vector[shared + SHARED + n * REMEMBERED + HELD]
        row[at], row[at + 1] = supply_state(gas.world[0], gas.vector, shared, held)[0], exhaust_state(gas.world[0], gas.vector, shared)[0]
