"""The compiled loop of a replay: recorded inputs in, MuJoCo and the gas step by step, set right at the start of every window."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics import chamber, state
from exo_sim.physics.compiled import borrow, kernel
from exo_sim.physics.nodes import LOWEST, change_hose_pressure, pressures, sensed_pressures, volumes
from exo_sim.physics.plant import FOLLOWED
from exo_sim.physics.transmission import gives
from exo_sim.simulation.coupled_step import advance_gas, compute_forces, freshen_levers
from exo_sim.simulation.mujoco_calls import call

Array = NDArray[np.float64]
Index = NDArray[np.int64]

#: Beyond this speed (m/s, rad/s) or pressure [Pa] a simulation has left what can be.
FASTEST, HIGHEST = 1e5, 1e9


class Feed(NamedTuple):
    """Inputs on the simulation's steps, n of them.

    Attributes:
        command: Valve commands, the mean over the step that follows, shape (n, commands).
        external: Generalised forces from outside, shape (n, joints).
        supply, supply_temperature, exhaust: In the middle of that step, shape (n,).
        position, velocity: Measured motion of the recorded joints, velocity half a step before, shape (n, joints).
        qpos_at, dof_at: Where those joints stand in MuJoCo's vectors, shape (joints,).
        imposed: Whether motion is imposed as measured; else it is predicted.
        starts: Steps at which the measured state is taken over, rising, shape (w,).
        pressure: Measured pressures there, shape (w, cylinders, 2); NaN keeps the predicted one.
        led: Pressures that are imposed at every step, shape (n, cylinders, 2), NaN where they are predicted; shape (0, 0, 0) where all are.
    """

    command: Array
    external: Array
    supply: Array
    supply_temperature: Array
    exhaust: Array
    position: Array
    velocity: Array
    qpos_at: Index
    dof_at: Index
    imposed: bool
    starts: Index
    pressure: Array
    led: Array


@kernel
def _fill(vector, mass, energy, volume, k, pressure):
    """Give a volume another pressure [Pa] with its temperature kept."""
    factor = max(pressure, LOWEST) / chamber.pressure(vector[energy], volume, k)
    vector[mass] *= factor
    vector[energy] *= factor


@kernel
def _set_pressures(mechanics, plant, targets):
    """Give each chamber its measured pressure where there is one; temperature, spool and contacts are carried on.

    A hose's gas changes by what its sensor was missed by before the piston is put to where it was measured: that leap compresses
    nothing.
    """
    world = plant.world[0]
    n = len(plant.cylinders)
    memory = n * state.INTEGRATED + state.SHARED
    for i in range(n):
        c = plant.cylinders[i]
        place = memory + i * state.REMEMBERED
        base = i * state.INTEGRATED
        before = _piston(plant, i)
        seen_1, seen_2 = sensed_pressures(world, c, plant.vector, base, before)
        p_1, p_2 = pressures(world, c, plant.vector, base, before)
        x = mechanics.actuator_length[plant.actuators[i]] - plant.retracted[i]
        at = x
        if gives(c):  # the transmission stays as far deflected as it was
            plant.vector[place + state.PISTON] += x - plant.x[i]
            at = plant.vector[place + state.PISTON]
        plant.x[i] = x
        v_1, v_2 = volumes(c, at)
        for side in range(2):
            target = targets[i, side]
            if math.isnan(target) or (side == 1 and c.single_acting > 0.0):
                continue
            change = target - (seen_1 if side == 0 else seen_2)
            p, volume = (p_1, v_1) if side == 0 else (p_2, v_2)
            _fill(plant.vector, base + 2 * side, base + 2 * side + 1, volume, world.k, p + change)
            change_hose_pressure(c, plant.vector, base, side, change, world.k)


@kernel
def _lost(mechanics, plant, motion):
    for d in range(mechanics.qvel.size):
        if motion and not abs(mechanics.qvel[d]) < FASTEST:
            return True
    for i in range(len(plant.cylinders)):
        energy = (
            plant.vector[i * state.INTEGRATED + state.ENERGY_1]
            + plant.vector[i * state.INTEGRATED + state.ENERGY_2]
        )
        if not abs(energy) < HIGHEST:
            return True
    return False


@kernel
def run(first, stop, window, mechanics, plant, feed, filled, shown_pressure, shown_position):
    """Take the steps from `first` to `stop`; return the number of windows begun so far, negative where the last one is lost.

    Order: motion of now; gas up to now, or set right; what sensors see; inputs and rod forces; MuJoCo's step. A window whose
    numbers mean nothing any more stays NaN to its end.

    Args:
        window: What the call before returned; 0 at first.
        filled: Vector of the state to begin anew with after a loss.
        shown_pressure: Result at the step's start, shape (n, cylinders, 2).
        shown_position: Result, shape (n, joints).
    """
    mechanics, plant, feed = borrow(mechanics), borrow(plant), borrow(feed)
    lost = window < 0
    window = abs(window)
    n, m = len(plant.cylinders), len(plant.joints)
    for k in range(first, stop):
        begins = window < feed.starts.size and feed.starts[window] == k
        if begins or feed.imposed:
            for j in range(feed.qpos_at.size):
                mechanics.qpos[feed.qpos_at[j]] = feed.position[k, j]
                mechanics.qvel[feed.dof_at[j]] = feed.velocity[k, j]
        if begins:
            if lost:
                plant.vector[:] = filled
            lost = False
        if lost:
            shown_pressure[k] = np.nan
            shown_position[k] = np.nan
            continue
        call(mechanics.step1, mechanics.model, mechanics.data)
        if begins:
            if n > 0:
                _set_pressures(mechanics, plant, feed.pressure[window])
            for i in range(m):
                plant.q[i] = mechanics.qpos[plant.addresses[i]]
            window += 1
        else:
            became = advance_gas(mechanics, plant)
            if became != FOLLOWED or _lost(mechanics, plant, not feed.imposed):
                lost = True
                shown_pressure[k] = np.nan
                shown_position[k] = np.nan
                continue
            if feed.led.size > 0:
                _set_pressures(mechanics, plant, feed.led[k])
        for i in range(n):
            seen = sensed_pressures(
                plant.world[0], plant.cylinders[i], plant.vector, i * state.INTEGRATED, _piston(plant, i)
            )
            shown_pressure[k, i, 0], shown_pressure[k, i, 1] = seen
        for j in range(feed.qpos_at.size):
            shown_position[k, j] = mechanics.qpos[feed.qpos_at[j]]
        plant.world[0].supply_pressure = feed.supply[k]
        plant.world[0].supply_temperature = feed.supply_temperature[k]
        plant.world[0].exhaust_pressure = feed.exhaust[k]
        for i in range(plant.command.size):
            plant.command[i] = feed.command[k, i]
        if feed.imposed:
            continue
        freshen_levers(mechanics, plant)
        mechanics.qfrc_applied[:] = 0.0
        for j in range(feed.dof_at.size):
            mechanics.qfrc_applied[feed.dof_at[j]] = feed.external[k, j]
        plant.felt[:] = 0.0
        compute_forces(mechanics, plant)
        call(mechanics.step2, mechanics.model, mechanics.data)
    return -window if lost else window


@kernel
def _piston(plant, i):
    """Return where the piston of a cylinder is."""
    if gives(plant.cylinders[i]):
        place = len(plant.cylinders) * state.INTEGRATED + state.SHARED + i * state.REMEMBERED
        return plant.vector[place + state.PISTON]
    return plant.x[i]
