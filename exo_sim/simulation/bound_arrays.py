"""One compiled call a step, on arrays that stay where they are: handing over twenty takes longer than the gas does."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from llvmlite import ir
from numba import carray, types
from numba.extending import intrinsic

from exo_sim.physics.compiled import kernel
from exo_sim.physics.records import CYLINDER, JOINT, WORLD
from exo_sim.simulation.coupling import advance_gas, compute_forces, moment_arm
from exo_sim.simulation.native import address, call, read_time

if TYPE_CHECKING:
    import mujoco

    from exo_sim.simulation.plugin import PneumaticPlugin

#: Order of the arrays, then of the sizes, then of MuJoCo's own, in the table.
_ARRAYS = (
    WORLD_AT, CYLINDERS, JOINTS, VECTOR, HISTORY, ACTUATORS, RETRACTED, LENGTH, VELOCITY, DOFS, ADDRESSES, QPOS, QVEL,
    CTRL, APPLIED, X, X1, V, FORCE, Q, Q1, QD, OWN, FELT, COMMAND, WORK, SCRATCH, DT, CLOCK, DRIVEN, MOMENT, COUNTS,
    STARTS, COLUMNS,
) = range(34)  # fmt: skip
_SIZES = N, M, STATES, RING, INTEGRATED, NU, NQ, NV, MOMENTS, TURNING = range(34, 44)
_MUJOCO = STEP1, STEP2, GET_STATE, MODEL, DATA = range(44, 49)
_LENGTH_OF_TABLE = 49


class BoundArrays:
    """Addresses of what one plug-in and one MjData work on; it keeps both alive.

    Attributes:
        data: That MjData.
        place: Address of the table, for `take_step`.
    """

    def __init__(self, plugin: PneumaticPlugin, data: mujoco.MjData):
        gas, model = plugin.pneumatics, plugin.model
        arrays = [
            gas.world, gas.cylinders, gas.joints, gas.vector, gas.history, plugin._actuators, plugin._retracted,
            data.actuator_length, data.actuator_velocity, plugin._dofs, plugin._addresses, data.qpos, data.qvel,
            data.ctrl, data.qfrc_applied, plugin._x, plugin._x1, plugin._v, plugin._force, plugin._q, plugin._q1,
            plugin._qd, plugin._own, plugin._felt, plugin.command, gas._work, gas._scratch, np.array([plugin.dt]),
            plugin._clock, plugin._driven, data.actuator_moment, data.moment_rownnz, data.moment_rowadr,
            data.moment_colind,
        ]  # fmt: skip
        assert all(array.flags.c_contiguous for array in arrays)
        n, ring = gas.history.shape
        sizes = [n, len(gas.joints), gas.vector.size, ring, gas._work.shape[1], model.nu, model.nq, model.nv]
        sizes += [data.actuator_moment.size, int(plugin._turning)]
        own = [address("mj_step1"), address("mj_step2"), address("mj_getState"), model._address, data._address]
        self.data, self._arrays = data, arrays
        self._table = np.array([array.ctypes.data for array in arrays] + sizes + own, dtype=np.int64)
        self.place = self._table.ctypes.data


def _to_pointer(typingctx: Any, address: Any) -> Any:
    """Turn an address into a pointer that `carray` takes."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], ir.IntType(8).as_pointer())

    return types.voidptr(types.int64), generate


_pointer: Any = intrinsic(_to_pointer)


@kernel
def _numbers(at, which, count):
    return carray(_pointer(at[which]), (count,), np.float64)


@kernel
def _indices(at, which, count):
    return carray(_pointer(at[which]), (count,), np.int64)


@kernel
def _short_indices(at, which, count):
    return carray(_pointer(at[which]), (count,), np.int32)


@kernel
def take_step(place):
    """Take one coupled step on what the table at `place` names: `PneumaticPlugin.step`, compiled."""
    at = carray(_pointer(place), (_LENGTH_OF_TABLE,), np.int64)
    n, m = at[N], at[M]
    world = carray(_pointer(at[WORLD_AT]), (1,), WORLD)[0]
    cylinders = carray(_pointer(at[CYLINDERS]), (n,), CYLINDER)
    joints = carray(_pointer(at[JOINTS]), (m,), JOINT)
    vector = _numbers(at, VECTOR, at[STATES])
    actuators, retracted = _indices(at, ACTUATORS, n), _numbers(at, RETRACTED, n)
    length, velocity = _numbers(at, LENGTH, at[NU]), _numbers(at, VELOCITY, at[NU])
    dofs, addresses = _indices(at, DOFS, m), _indices(at, ADDRESSES, m)
    qpos, qvel = _numbers(at, QPOS, at[NQ]), _numbers(at, QVEL, at[NV])
    x, q = _numbers(at, X, n), _numbers(at, Q, m)
    clock, dt = _numbers(at, CLOCK, 2), _numbers(at, DT, 1)[0]
    call(at[STEP1], at[MODEL], at[DATA])
    read_time(at[GET_STATE], at[MODEL], at[DATA], at[CLOCK] + 8)
    if clock[1] > clock[0] + 0.5 * dt:
        advance_gas(
            world, cylinders, joints, vector, carray(_pointer(at[HISTORY]), (n, at[RING]), np.float64), actuators,
            retracted, length, addresses, qpos, _numbers(at, COMMAND, n), dt, x, _numbers(at, X1, n), q,
            _numbers(at, Q1, m), carray(_pointer(at[WORK]), (5, at[INTEGRATED]), np.float64),
            carray(_pointer(at[SCRATCH]), (6, n), np.float64),
        )  # fmt: skip
        clock[0] = clock[1]
    if at[TURNING]:
        driven, moment = _indices(at, DRIVEN, n), _numbers(at, MOMENT, at[MOMENTS])
        counts, starts = _short_indices(at, COUNTS, at[NU]), _short_indices(at, STARTS, at[NU])
        columns = _short_indices(at, COLUMNS, at[MOMENTS])
        for i in range(n):
            cylinders[i].arm = moment_arm(actuators[i], driven[i], moment, counts, starts, columns)
    compute_forces(
        world, cylinders, joints, vector, actuators, retracted, length, velocity, dofs, addresses, qpos, qvel,
        _numbers(at, CTRL, at[NU]), _numbers(at, APPLIED, at[NV]), x, _numbers(at, V, n), _numbers(at, FORCE, n), q,
        _numbers(at, QD, m), _numbers(at, OWN, m), _numbers(at, FELT, m),
    )  # fmt: skip
    call(at[STEP2], at[MODEL], at[DATA])


def straight(function: Callable[[int], None]) -> Callable[[int], None]:
    """Return the compiled code of a kernel of one address, without the dispatcher that would ask each time of what type it is."""
    dispatcher: Any = function
    dispatcher.compile((types.int64,))
    return dispatcher.overloads[(types.int64,)].entry_point  # type: ignore[no-any-return]
