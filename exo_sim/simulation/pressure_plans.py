"""Planned chamber pressures of a worn machine: `control.pressure_plan` for each cylinder along the reference motion."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.control.pressure_plan import INTERVALS, plan
from exo_sim.gait.motion import Motion, WholeTrial, look_up
from exo_sim.machine.linkage import moment_row
from exo_sim.simulation.plugin import PneumaticPlugin

Array = NDArray[np.float64]
#: Arm below which a cylinder makes no torque [m].
_LEAST_ARM = 5e-3
#: First degree of freedom of the right leg.
_FIRST_RIGHT = 6
#: Share of their range by which both sides of a machine may differ and still have one plan.
_ALIKE = 0.01
#: What decides a plan besides position and force.
_ALIKE_OF = ("area_1", "area_2", "stroke", "dead_volume_1", "dead_volume_2", "valve_area", "valve_edges")


def nothing(count: int) -> Array:
    """Return the table of a machine that has no plan."""
    return np.empty((0, 2 * count))


def planned(plugin: PneumaticPlugin) -> bool:
    """Return whether any cylinder of a machine follows a plan."""
    return any(c.valve.independent and not c.single_acting for c in plugin.rig.cylinders.values())


def along(plugin: PneumaticPlugin, motion: Motion, data: mujoco.MjData) -> tuple[Array, Array]:
    """Return piston positions [m] and moment arms [m] of all cylinders along the motion, shape (INTERVALS, n) each.

    Args:
        plugin: The cylinders on their model.
        motion: The reference.
        data: Of the model, to work in; its positions are overwritten.
    """
    model = plugin.model
    x, arm = np.empty((INTERVALS, len(plugin.links))), np.empty((INTERVALS, len(plugin.links)))
    positions = motion.at(np.arange(INTERVALS) / INTERVALS)
    for j, q in enumerate(positions):
        data.qpos[:] = q
        mujoco.mj_fwdPosition(model, data)
        for i, link in enumerate(plugin.links):
            x[j, i] = data.actuator_length[link.actuator] - plugin.rig.cylinders[link.cylinder].retracted_length
            arm[j, i] = moment_row(model, data, link.actuator)[link.dof]
    return x, arm


def pressures(plugin: PneumaticPlugin, motion: Motion, demand: Array, preview: float = 0.0) -> Array:
    """Return planned pressures [Pa], both chambers of each cylinder, the first row repeated behind the last, (INTERVALS + 1, 2 n).

    Args:
        plugin: The cylinders on their model.
        motion: The reference.
        demand: Joint torques wanted along the cycle [N m], the first row repeated behind the last, shape (m + 1, 6).
        preview: How far ahead the demand is read [s].
    """
    x, arm = along(plugin, motion, mujoco.MjData(plugin.model))
    cylinders, world = plugin.pneumatics.cylinders, plugin.pneumatics.world[0]
    torque = np.empty((INTERVALS, 6))
    for j in range(INTERVALS):
        look_up(j / INTERVALS + preview / motion.period, demand, torque[j])
    out = np.full((INTERVALS + 1, 2 * len(plugin.links)), float(world["exhaust_pressure"]))
    force = np.zeros_like(x)
    for i, link in enumerate(plugin.links):
        cylinder = plugin.rig.cylinders[link.cylinder]
        if not cylinder.valve.independent or cylinder.single_acting:
            continue
        force[:, i] = torque[:, link.dof - 3] / np.where(np.abs(arm[:, i]) > _LEAST_ARM, arm[:, i], np.inf)
        force[:, i] += cylinders[i]["return_spring"]["stiffness"] * (x[:, i] - cylinders[i]["return_spring"]["rest"])
        twin = next((j for j in range(i) if _mirrored(plugin, x, force, i, j)), None)
        if twin is None:
            found = plan(world, cylinders[i], x[:, i], force[:, i], motion.period)
            out[:-1, 2 * i], out[:-1, 2 * i + 1] = found.pressure_1, found.pressure_2
        else:
            out[:-1, 2 * i : 2 * i + 2] = np.roll(out[:-1, 2 * twin : 2 * twin + 2], INTERVALS // 2, axis=0)
    out[-1] = out[0]
    return out


def played(table: Array, trial: WholeTrial, plugin: PneumaticPlugin) -> Array:
    """Return a plan over the mean stride's phase at the phases of a whole trial, each cylinder's by the foot of its side."""
    if not len(table):
        return table
    sides = np.repeat([0 if link.dof < _FIRST_RIGHT else 3 for link in plugin.links], 2)
    columns = [trial.played(np.repeat(column[:, None], 6, axis=1))[:, side] for column, side in zip(table.T, sides)]
    return np.ascontiguousarray(np.stack(columns, axis=1))


def _mirrored(plugin: PneumaticPlugin, x: Array, force: Array, i: int, j: int) -> bool:
    """Return whether cylinder i does half a cycle later what a cylinder j of the same kind does."""
    one, other = plugin.pneumatics.cylinders[i], plugin.pneumatics.cylinders[j]
    if any(one[name] != other[name] for name in _ALIKE_OF):
        return False
    return all(np.allclose(v[:, i], np.roll(v[:, j], INTERVALS // 2), atol=_ALIKE * np.ptp(v[:, j])) for v in (x, force))
