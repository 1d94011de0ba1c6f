"""The compiled loop of a replay: recorded inputs in, MuJoCo and the gas step by step, set right at the start of every window."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics import chamber, plant, state
from exo_sim.physics.compiled import kernel
from exo_sim.physics.nodes import sensed_pressures
from exo_sim.physics.transmission import gives
from exo_sim.simulation.coupling import advance_gas, compute_forces
from exo_sim.simulation.native import call

Array = NDArray[np.float64]
Index = NDArray[np.int64]

#: Beyond this speed (m/s, rad/s) or pressure [Pa] a simulation has left what can be.
FASTEST, HIGHEST = 1e5, 1e9


class Machine(NamedTuple):
    """MuJoCo's functions, model and data by address; views into both; the plant as the plug-in holds it."""

    step1: int
    step2: int
    model: int
    data: int
    dt: float
    qpos: Array
    qvel: Array
    ctrl: Array
    applied: Array
    length: Array
    velocity: Array
    moment: Array
    rownnz: NDArray[np.int32]
    rowadr: NDArray[np.int32]
    colind: NDArray[np.int32]
    world: NDArray[np.void]
    cylinders: NDArray[np.void]
    joints: NDArray[np.void]
    vector: Array
    history: Array
    actuators: Index
    drives: Index
    retracted: Array
    dofs: Index
    addresses: Index
    x: Array
    x1: Array
    v: Array
    force: Array
    q: Array
    q1: Array
    qd: Array
    own: Array
    felt: Array
    command: Array
    work: Array
    scratch: Array


class Feed(NamedTuple):
    """Inputs on the simulation's steps, n of them.

    Attributes:
        command: Valve commands, the mean over the step that follows, shape (n, cylinders).
        external: Generalised forces from outside, shape (n, joints).
        supply, supply_temperature, exhaust: In the middle of that step, shape (n,).
        position, velocity: Measured motion of the recorded joints, velocity half a step before, shape (n, joints).
        qpos_at, dof_at: Where those joints stand in MuJoCo's vectors, shape (joints,).
        imposed: Motion is led as measured; else it is predicted.
        starts: Steps at which the measured state is taken over, rising, shape (w,).
        pressure: Measured pressures there, shape (w, cylinders, 2); NaN keeps the predicted one.
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


@kernel
def _rescale(vector, mass, energy, volume, k, change):
    """Raise a volume's pressure by `change` [Pa] with its temperature kept."""
    p = chamber.pressure(vector[energy], volume, k)
    factor = max(p + change, 1000.0) / p
    vector[mass] *= factor
    vector[energy] *= factor


@kernel
def _set_pressures(machine, targets):
    """Give each chamber its measured pressure where there is one; temperature, spool and contacts are carried on."""
    world = machine.world[0]
    n = len(machine.cylinders)
    memory = n * state.INTEGRATED + state.SHARED
    for i in range(n):
        c = machine.cylinders[i]
        place = memory + i * state.REMEMBERED
        x = machine.length[machine.actuators[i]] - machine.retracted[i]
        at = x
        if gives(c):  # the transmission stays as far deflected as it was
            machine.vector[place + state.PISTON] += x - machine.x[i]
            at = machine.vector[place + state.PISTON]
        machine.x[i] = x
        base = i * state.INTEGRATED
        v_1, v_2 = plant.volumes(c, at)
        seen_1, seen_2 = sensed_pressures(world, c, machine.vector, base, at)
        hose = c.line_restriction.area > 0.0
        for side in range(2):
            target = targets[i, side]
            if math.isnan(target) or (side == 1 and c.single_acting > 0.0):
                continue
            change = target - (seen_1 if side == 0 else seen_2)
            volume = v_1 if side == 0 else v_2
            _rescale(machine.vector, base + 2 * side, base + 2 * side + 1, volume, world.k, change)
            if hose:
                mass, energy = base + state.HOSE_MASS_1 + 2 * side, base + state.HOSE_ENERGY_1 + 2 * side
                _rescale(machine.vector, mass, energy, c.line_restriction.volume, world.k, change)


@kernel
def _arms(machine):
    """Freshen the lever of each cylinder at the joint it drives."""
    for i in range(len(machine.cylinders)):
        a = machine.actuators[i]
        for j in range(machine.rowadr[a], machine.rowadr[a] + machine.rownnz[a]):
            if machine.colind[j] == machine.drives[i]:
                machine.cylinders[i]["arm"] = machine.moment[j]


@kernel
def _lost(machine, motion):
    for d in range(machine.qvel.size):
        if motion and not abs(machine.qvel[d]) < FASTEST:
            return True
    for i in range(len(machine.cylinders)):
        energy = (
            machine.vector[i * state.INTEGRATED + state.ENERGY_1]
            + machine.vector[i * state.INTEGRATED + state.ENERGY_2]
        )
        if not abs(energy) < HIGHEST:
            return True
    return False


@kernel
def run(first, stop, window, machine, feed, filled, shown_pressure, shown_position):
    """Take the steps from `first` to `stop`; return the number of windows begun so far, negative where the last one is lost.

    Order: motion of now; gas up to now, or set right; what sensors see; inputs and rod forces; MuJoCo's step. A window whose
    numbers mean nothing any more stays NaN to its end.

    Args:
        window: What the call before returned; 0 at first.
        filled: Vector of the state to begin anew with after a loss.
        shown_pressure: Result at the step's start, shape (n, cylinders, 2).
        shown_position: Result, shape (n, joints).
    """
    lost = window < 0
    window = abs(window)
    n, m = len(machine.cylinders), len(machine.joints)
    for k in range(first, stop):
        begins = window < feed.starts.size and feed.starts[window] == k
        if begins or feed.imposed:
            for j in range(feed.qpos_at.size):
                machine.qpos[feed.qpos_at[j]] = feed.position[k, j]
                machine.qvel[feed.dof_at[j]] = feed.velocity[k, j]
        if begins:
            if lost:
                machine.vector[:] = filled
            lost = False
        if lost:
            shown_pressure[k] = np.nan
            shown_position[k] = np.nan
            continue
        call(machine.step1, machine.model, machine.data)
        if begins:
            if n > 0:
                _set_pressures(machine, feed.pressure[window])
            for i in range(m):
                machine.q[i] = machine.qpos[machine.addresses[i]]
            window += 1
        else:
            advance_gas(
                machine.world[0], machine.cylinders, machine.joints, machine.vector, machine.history, machine.actuators,
                machine.retracted, machine.length, machine.addresses, machine.qpos, machine.command, machine.dt, machine.x,
                machine.x1, machine.q, machine.q1, machine.work, machine.scratch,
            )  # fmt: skip
            if _lost(machine, not feed.imposed):
                lost = True
                shown_pressure[k] = np.nan
                shown_position[k] = np.nan
                continue
        for i in range(n):
            seen = sensed_pressures(
                machine.world[0], machine.cylinders[i], machine.vector, i * state.INTEGRATED, _piston(machine, i)
            )
            shown_pressure[k, i, 0], shown_pressure[k, i, 1] = seen
        for j in range(feed.qpos_at.size):
            shown_position[k, j] = machine.qpos[feed.qpos_at[j]]
        machine.world[0].supply_pressure = feed.supply[k]
        machine.world[0].supply_temperature = feed.supply_temperature[k]
        machine.world[0].exhaust_pressure = feed.exhaust[k]
        for i in range(n):
            machine.command[i] = feed.command[k, i]
        if feed.imposed:
            continue
        _arms(machine)
        machine.applied[:] = 0.0
        for j in range(feed.dof_at.size):
            machine.applied[feed.dof_at[j]] = feed.external[k, j]
        machine.felt[:] = 0.0
        compute_forces(
            machine.world[0], machine.cylinders, machine.joints, machine.vector, machine.actuators, machine.retracted,
            machine.length, machine.velocity, machine.dofs, machine.addresses, machine.qpos, machine.qvel, machine.ctrl,
            machine.applied, machine.x, machine.v, machine.force, machine.q, machine.qd, machine.own, machine.felt,
        )  # fmt: skip
        call(machine.step2, machine.model, machine.data)
    return -window if lost else window


@kernel
def _piston(machine, i):
    """Return where the piston of a cylinder is."""
    if gives(machine.cylinders[i]):
        place = len(machine.cylinders) * state.INTEGRATED + state.SHARED + i * state.REMEMBERED
        return machine.vector[place + state.PISTON]
    return machine.x[i]
