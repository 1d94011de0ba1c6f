"""One compiled call a step, on arrays that stay where they are: handing over twenty takes longer than the gas does."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from llvmlite import ir
from numba import carray, types
from numba.extending import intrinsic

from exo_sim.physics.compiled import kernel
from exo_sim.physics.records import CYLINDER, JOINT, WORLD
from exo_sim.simulation.coupling import advance_gas, compute_forces

if TYPE_CHECKING:
    import mujoco

    from exo_sim.simulation.plugin import PneumaticPlugin

#: Order of the arrays, then of the sizes, in `BoundArrays.addresses`.
_ARRAYS = (
    WORLD_AT, CYLINDERS, JOINTS, VECTOR, HISTORY, ACTUATORS, RETRACTED, LENGTH, VELOCITY, DOFS, ADDRESSES, QPOS, QVEL,
    CTRL, APPLIED, X, X1, V, FORCE, Q, Q1, QD, OWN, FELT, COMMAND, WORK, SCRATCH, DT,
) = range(28)  # fmt: skip
_SIZES = N, M, STATES, RING, INTEGRATED, NU, NQ, NV = range(28, 36)


class BoundArrays:
    """Addresses of what one plug-in and one MjData work on; it keeps both alive.

    Attributes:
        addresses: Of the arrays, then the sizes, shape (36,).
    """

    def __init__(self, plugin: PneumaticPlugin, data: mujoco.MjData):
        gas, model = plugin.pneumatics, plugin.model
        arrays = [
            gas.world, gas.cylinders, gas.joints, gas.vector, gas.history, plugin._actuators, plugin._retracted,
            data.actuator_length, data.actuator_velocity, plugin._dofs, plugin._addresses, data.qpos, data.qvel,
            data.ctrl, data.qfrc_applied, plugin._x, plugin._x1, plugin._v, plugin._force, plugin._q, plugin._q1,
            plugin._qd, plugin._own, plugin._felt, plugin.command, gas._work, gas._scratch, np.array([plugin.dt]),
        ]  # fmt: skip
        assert all(array.flags.c_contiguous for array in arrays)
        n, ring = gas.history.shape
        sizes = [n, len(gas.joints), gas.vector.size, ring, gas._work.shape[1], model.nu, model.nq, model.nv]
        self._data, self._arrays = data, arrays
        self.addresses = np.array([array.ctypes.data for array in arrays] + sizes, dtype=np.int64)

    def hold(self, plugin: PneumaticPlugin, data: mujoco.MjData) -> bool:
        """Return whether these are still the arrays of plug-in and data."""
        return data is self._data and plugin.command is self._arrays[COMMAND]


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
def advance_and_compute(at, late):
    """Bring the gas up to now where it is `late`, then write the rod forces; `at` are `BoundArrays.addresses`."""
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
    if late:
        advance_gas(
            world, cylinders, joints, vector, carray(_pointer(at[HISTORY]), (n, at[RING]), np.float64), actuators,
            retracted, length, addresses, qpos, _numbers(at, COMMAND, n), _numbers(at, DT, 1)[0], x,
            _numbers(at, X1, n), q, _numbers(at, Q1, m), carray(_pointer(at[WORK]), (5, at[INTEGRATED]), np.float64),
            carray(_pointer(at[SCRATCH]), (6, n), np.float64),
        )  # fmt: skip
    compute_forces(
        world, cylinders, joints, vector, actuators, retracted, length, velocity, dofs, addresses, qpos, qvel,
        _numbers(at, CTRL, at[NU]), _numbers(at, APPLIED, at[NV]), x, _numbers(at, V, n), _numbers(at, FORCE, n), q,
        _numbers(at, QD, m), _numbers(at, OWN, m), _numbers(at, FELT, m),
    )  # fmt: skip
