"""The plug-in's step as one compiled call: every array it touches is found by address, so that nothing is unpacked.

Handing thirty arrays to a compiled function costs more than the gas itself. Their addresses do not change as long as model,
data and plug-in stay, so they are collected once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
from numba import carray, types
from numba.extending import intrinsic
from numpy.typing import NDArray

from exo_sim.physics.compiled import kernel
from exo_sim.physics.records import CYLINDER, JOINT, WORLD
from exo_sim.simulation.coupling import advance_gas, compute_forces

if TYPE_CHECKING:
    from exo_sim.simulation.plugin import PneumaticPlugin


def _to_pointer(typingctx: Any, address: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(types.voidptr))

    return types.voidptr(types.int64), generate


_pointer: Any = intrinsic(_to_pointer)


class Wiring:
    """Where the arrays of one model, data and plug-in lie.

    Attributes:
        addresses: Address and number of rows of each array in turn, then the widths of history and work space; int64.
    """

    def __init__(self, plugin: PneumaticPlugin, data: mujoco.MjData):
        gas = plugin.pneumatics
        self._dt = np.array([plugin.dt])
        self._data, self._command = data, plugin.command
        self._arrays: tuple[NDArray[Any], ...] = (
            gas.world, gas.cylinders, gas.joints, gas.vector, gas.history, plugin._actuators, plugin._retracted,
            data.actuator_length, data.actuator_velocity, plugin._dofs, plugin._addresses, data.qpos, data.qvel,
            data.ctrl, data.qfrc_applied, plugin.command, plugin._x, plugin._x1, plugin._v, plugin._force, plugin._q,
            plugin._q1, plugin._qd, plugin._own, plugin._felt, gas._work, gas._scratch, self._dt,
        )  # fmt: skip
        self._gas = (gas, gas.world, gas.cylinders, gas.joints, gas.vector, gas.history)
        for array in self._arrays:
            assert array.flags.c_contiguous
        self.addresses = np.array(
            [number for array in self._arrays for number in (array.ctypes.data, len(array))]
            + [gas.history.shape[1], gas._work.shape[1]],
            dtype=np.int64,
        )

    def holds(self, plugin: PneumaticPlugin, data: mujoco.MjData) -> bool:
        """Return whether these are still the arrays of this plug-in and data."""
        gas = plugin.pneumatics
        kept, world, cylinders, joints, vector, history = self._gas
        return (
            data is self._data
            and plugin.command is self._command
            and gas is kept
            and gas.world is world
            and gas.cylinders is cylinders
            and gas.joints is joints
            and gas.vector is vector
            and gas.history is history
        )


@kernel
def _numbers(addresses, k):
    return carray(_pointer(addresses[2 * k]), (addresses[2 * k + 1],), np.float64)


@kernel
def _table(addresses, k, width):
    return carray(_pointer(addresses[2 * k]), (addresses[2 * k + 1], width), np.float64)


@kernel
def _indices(addresses, k):
    return carray(_pointer(addresses[2 * k]), (addresses[2 * k + 1],), np.int64)


@kernel
def advance_and_compute(addresses, late):
    """Advance the gas where it is late, then write the rod forces; the arrays are those of `Wiring`, in its order.

    Args:
        addresses: `Wiring.addresses`.
        late: Whether a step has been taken since the gas was moved.
    """
    ring, integrated = addresses[56], addresses[57]
    world = carray(_pointer(addresses[0]), (1,), WORLD)
    cylinders = carray(_pointer(addresses[2]), (addresses[3],), CYLINDER)
    joints = carray(_pointer(addresses[4]), (addresses[5],), JOINT)
    vector, history = _numbers(addresses, 3), _table(addresses, 4, ring)
    actuators, retracted = _indices(addresses, 5), _numbers(addresses, 6)
    length, velocity = _numbers(addresses, 7), _numbers(addresses, 8)
    dofs, places = _indices(addresses, 9), _indices(addresses, 10)
    qpos, qvel, ctrl, applied = (
        _numbers(addresses, 11), _numbers(addresses, 12), _numbers(addresses, 13), _numbers(addresses, 14)
    )  # fmt: skip
    command = _numbers(addresses, 15)
    x, x1, v, force = (
        _numbers(addresses, 16), _numbers(addresses, 17), _numbers(addresses, 18), _numbers(addresses, 19)
    )  # fmt: skip
    q, q1, qd = _numbers(addresses, 20), _numbers(addresses, 21), _numbers(addresses, 22)
    own, felt = _numbers(addresses, 23), _numbers(addresses, 24)
    if late:
        work, scratch = _table(addresses, 25, integrated), _table(addresses, 26, addresses[3])
        advance_gas(
            world[0], cylinders, joints, vector, history, actuators, retracted, length, places, qpos, command,
            _numbers(addresses, 27)[0], x, x1, q, q1, work, scratch,
        )  # fmt: skip
    compute_forces(
        world[0], cylinders, joints, vector, actuators, retracted, length, velocity, dofs, places, qpos, qvel, ctrl,
        applied, x, v, force, q, qd, own, felt,
    )  # fmt: skip
