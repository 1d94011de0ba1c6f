"""One compiled call a step, on arrays that stay where they are: handing over forty takes longer than the gas does."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array
from numpy.typing import NDArray

from exo_sim.physics.compiled import kernel
from exo_sim.physics.plant_records import CYLINDER, JOINT, WORLD
from exo_sim.simulation.coupled_step import coupled_step
from exo_sim.simulation.views import Mechanics, Plant

_RECORDS = {"world": WORLD, "cylinders": CYLINDER, "joints": JOINT}
_NUMBERS = {"Array": np.float64, "Table": np.float64, "Index": np.int64, "ShortIndex": np.int32}


def _example(kind: type) -> Any:
    """Return a value of a record of views, for its type alone."""
    values: list[Any] = []
    for name, annotation in kind.__annotations__.items():
        said = annotation.__forward_arg__
        shape = (1, 1) if said == "Table" else (1,)
        values.append(0 if said == "int" else np.zeros(shape, _RECORDS.get(name, _NUMBERS.get(said))))
    return kind(*values)


_MECHANICS, _PLANT = numba.typeof(_example(Mechanics)), numba.typeof(_example(Plant))


def _table(views: NamedTuple) -> NDArray[np.int64]:
    """Return a record of views as numbers: an integer as it is, an array as its address and shape."""
    numbers: list[int] = []
    for view in views:
        if isinstance(view, np.ndarray):
            assert view.flags.c_contiguous
            numbers += [view.ctypes.data, *view.shape]
        else:
            numbers.append(view)
    return np.array(numbers, dtype=np.int64)


def _reader(kind: Any) -> Any:
    """Return the intrinsic that reads a record of views from such a table: no reference is counted for its arrays."""

    def read(typingctx: Any, place: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            word = ir.IntType(64)
            table = builder.inttoptr(arguments[0], word.as_pointer())
            at = 0

            def number() -> Any:
                nonlocal at
                at += 1
                return builder.load(builder.gep(table, [ir.Constant(word, at - 1)]))

            record = context.get_constant_undef(kind)
            for field, member in enumerate(kind.types):
                if not isinstance(member, types.Array):
                    record = builder.insert_value(record, number(), field)
                    continue
                array = make_array(member)(context, builder)
                address, shape = number(), [number() for _ in range(member.ndim)]
                itemsize = ir.Constant(word, context.get_abi_sizeof(context.get_data_type(member.dtype)))
                strides = [itemsize]
                for length in reversed(shape[1:]):
                    strides.insert(0, builder.mul(strides[0], length))
                populate_array(
                    array, data=builder.inttoptr(address, array.data.type), shape=shape, strides=strides, itemsize=itemsize, meminfo=None
                )
                record = builder.insert_value(record, array._getvalue(), field)
            return record

        return kind(types.int64), generate

    return intrinsic(read)


_mechanics_at, _plant_at = _reader(_MECHANICS), _reader(_PLANT)


class Bound:
    """What one plug-in and one MjData work on, by address; it keeps both alive.

    Attributes:
        places: Addresses of both tables, for `take_step`.
    """

    def __init__(self, mechanics: Mechanics, plant: Plant, *kept: object):
        self._kept = (mechanics, plant, *kept)
        assert numba.typeof(mechanics) == _MECHANICS and numba.typeof(plant) == _PLANT
        self._tables = _table(mechanics), _table(plant)
        self.places = int(self._tables[0].ctypes.data), int(self._tables[1].ctypes.data)


@kernel
def take_step(mechanics, plant):
    """Take one coupled step on what the tables at two addresses name; return what became of the gas."""
    return coupled_step(_mechanics_at(mechanics), _plant_at(plant))


def straight(function: Callable[..., int]) -> Callable[..., int]:
    """Return the compiled code of a kernel of two addresses, without the dispatcher that would ask each time of what type they are."""
    dispatcher: Any = function
    arguments = (types.int64, types.int64)
    dispatcher.compile(arguments)
    return dispatcher.overloads[arguments].entry_point  # type: ignore[no-any-return]
