"""The arrays of the coupled step, named once: views into MuJoCo's data, and the plant with what lies between both."""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.pneumatics import Pneumatics
from exo_sim.simulation.mujoco_calls import address

Array = NDArray[np.float64]
Table = NDArray[np.float64]  # of two dimensions
Index = NDArray[np.int64]
ShortIndex = NDArray[np.int32]

#: Places in `Plant.clock`, compiled into the kernel: how far the gas has come, what MuJoCo's clock said last, and the length of a step [s];
#: and 1 where MuJoCo has been told to take a step since the gas was there, so that its clock must have moved.
GAS_TIME, MUJOCO_TIME, STEP, STEPPED = 0, 1, 2, 3


class Mechanics(NamedTuple):
    """MuJoCo's functions, model and data by address, and views into the data."""

    step1: int
    step2: int
    get_state: int
    model: int
    data: int
    qpos: Array
    qvel: Array
    ctrl: Array
    qfrc_applied: Array
    actuator_length: Array
    actuator_velocity: Array
    actuator_moment: Array
    moment_rownnz: ShortIndex
    moment_rowadr: ShortIndex
    moment_colind: ShortIndex


class Plant(NamedTuple):
    """n cylinders and m joints with contacts of their own.

    Attributes:
        world, cylinders, joints: Records, shapes (1,), (n,), (m,).
        vector, history: The state, and commands under way to their valves.
        work, scratch: Of `physics.plant`.
        actuators, driven: Of each cylinder its actuator, and the degree of freedom that it drives.
        retracted: Length of the actuator with the piston at its end [m].
        dofs, addresses: Of each joint its place in MuJoCo's velocities and positions.
        x, x1, v: Where each piston is by its joint, where it will have gone, and how fast it goes [m], [m/s].
        command: Of each valve; where any cylinder has a valve for each chamber, those towards chambers 2 behind the others; with a
            recovery tank those of the paths to it behind these, chambers 1 first.
        force: Of each rod [N].
        q, q1, qd: The same as x, x1, v of each joint.
        own, felt: What each joint's contact exerts, and what of it stands in MuJoCo's applied forces.
        turning: Not zero where a cylinder's contact must know its lever at the joint in every step.
        clock: Numbers at `GAS_TIME`, `MUJOCO_TIME`, `STEP`, `STEPPED`.
    """

    world: NDArray[np.void]
    cylinders: NDArray[np.void]
    joints: NDArray[np.void]
    vector: Array
    history: Table
    work: Table
    scratch: Table
    actuators: Index
    driven: Index
    retracted: Array
    dofs: Index
    addresses: Index
    x: Array
    x1: Array
    v: Array
    command: Array
    force: Array
    q: Array
    q1: Array
    qd: Array
    own: Array
    felt: Array
    turning: Index
    clock: Array


def mechanics(model: mujoco.MjModel, data: mujoco.MjData) -> Mechanics:
    """Return the views of one model and its data; whoever keeps them keeps both alive."""
    return Mechanics(
        address("mj_step1"), address("mj_step2"), address("mj_getState"), model._address, data._address,
        data.qpos, data.qvel, data.ctrl, data.qfrc_applied, data.actuator_length, data.actuator_velocity,
        data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind,
    )  # fmt: skip


def plant(
    gas: Pneumatics, actuators: Index, driven: Index, retracted: Array, dofs: Index, addresses: Index, turning: bool
) -> Plant:
    """Return the views of a plant, and new arrays for what lies between it and MuJoCo; arguments are those of `Plant`."""
    n, m = len(gas.cylinders), len(gas.joints)
    x, x1, v, force = np.zeros((4, n))
    command = np.zeros(gas.commands)
    q, q1, qd, own, felt = np.zeros((5, m))
    return Plant(
        gas.world, gas.cylinders, gas.joints, gas.vector, gas.history, gas._work, gas._scratch, actuators, driven, retracted,
        dofs, addresses, x, x1, v, command, force, q, q1, qd, own, felt, np.array([int(turning)]), np.array([0.0, 0.0, gas.dt, 0.0]),
    )  # fmt: skip
