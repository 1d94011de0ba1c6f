"""How a kernel is compiled, and where its machine code is kept.

numba's own cache does not notice a change in another file that a cached function calls or takes a number from, so the folder is
named after the text of all physics, of every file elsewhere that holds a kernel and of effects outside the package, and after the
versions that compile it: an edit is never met by stale code.
"""

from __future__ import annotations

import contextlib
import hashlib
import math
import os
import platform
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
import numpy
from llvmlite import ir
from numba import types
from numba.core import cgutils, config
from numba.core.caching import FunctionCache
from numba.core.runtime import rtsys
from numba.extending import intrinsic
from numba.np import arrayobj

from exo_sim.physics import compiled_cache, external_effects
from exo_sim.physics.linked_code import LinkedKernel

Function = TypeVar("Function", bound=Callable[..., Any])

#: Of numba: kernels release the GIL, and divide by zero as numpy does.
_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}

_PACKAGE = Path(__file__).resolve().parent.parent


def _holds_kernel(path: Path) -> bool:
    text = path.read_bytes()
    return b"kernel" in text or b"intrinsic" in text


def _sources() -> list[Path]:
    physics = f"{Path(__file__).resolve().parent}{os.sep}"
    own = [path for path in sorted(_PACKAGE.rglob("*.py")) if str(path).startswith(physics) or _holds_kernel(path)]
    return own + [source.path for source in external_effects.sources()]


def _key() -> str:
    digest = hashlib.sha256()
    for part in (numba.__version__, numpy.__version__, platform.python_version(), platform.machine(), str(_PACKAGE)):
        digest.update(part.encode())
    for path in _sources():
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


if (_folder := compiled_cache.folder(_key())) is not None:
    config.CACHE_DIR = str(_folder)  # type: ignore[attr-defined]


def kernel(function: Function) -> Function:
    """Compile a function of numbers, arrays and records; it releases the GIL and is cached between starts."""
    compiler: Any = numba.njit
    compiled = compiler(no_cfunc_wrapper=True, **_OPTIONS)(function)
    if _folder is not None:
        compiled._cache = _Kept(function)  # what `cache=True` does, with our kind of cache
    return compiled  # type: ignore[no-any-return]


def inlined_kernel(function: Function) -> Function:
    """Compile a kernel into the code of those that call it: for what every step of the gas calls.

    Records, arrays and tuples take a while to hand over: with the calls of one step inlined a prediction takes little more than half.
    """
    return LinkedKernel(function, kernel, **_OPTIONS)  # type: ignore[return-value]


class _Kept(FunctionCache):  # type: ignore[misc]
    """numba's cache; where the disk is full, machine code is used without being kept.

    Machine code that is there needs numba's runtime alone: numba would load all that it compiles with before it looks, a tenth of a short
    run. What is not there is compiled, and that loads it. Where a kernel's machine code lies is looked up when it is first called: most
    are only compiled into others.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self._of = function

    def __getattr__(self, name: str) -> Any:
        if "_of" not in self.__dict__ or "_impl" in self.__dict__:
            raise AttributeError(name)
        super().__init__(self._of)
        return getattr(self, name)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)

    def save_overload(self, sig: Any, data: Any) -> None:
        with contextlib.suppress(OSError):
            super().save_overload(sig, data)


def _borrow(typingctx: Any, arrays: Any) -> Any:
    """Return a tuple's values with the owners of its arrays, and of those in tuples in it, taken off: no reference is counted any more."""

    def freed(context: Any, builder: Any, kinds: Any, held: Any) -> Any:
        for place, kind in enumerate(kinds):
            if isinstance(kind, types.BaseTuple):
                held = builder.insert_value(held, freed(context, builder, kind, builder.extract_value(held, place)), place)
            elif isinstance(kind, types.Array):
                array = cgutils.create_struct_proxy(kind)(context, builder, builder.extract_value(held, place))
                array.meminfo = cgutils.get_null_value(array.meminfo.type)
                array.parent = cgutils.get_null_value(array.parent.type)
                held = builder.insert_value(held, array._getvalue(), place)
        return held

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return freed(context, builder, arrays, arguments[0])

    return arrays(arrays), generate


#: `borrow(tuple)` in compiled code whose caller keeps the arrays: counting their references costs more than small kernels do.
borrow: Any = intrinsic(_borrow)


def _own_copy(typingctx: Any, record: Any) -> Any:
    """Compile to a copy of a record on the stack of the kernel."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        words = signature.args[0].size // 8
        with builder.goto_entry_block():
            place = builder.alloca(ir.ArrayType(ir.DoubleType(), words))
        copy = builder.bitcast(place, context.get_value_type(signature.return_type))
        cgutils.raw_memcpy(builder, copy, arguments[0], ir.Constant(ir.IntType(64), signature.args[0].size), 1)
        return copy

    return record(record), generate


#: `own_copy(record)` in compiled code: the compiler then knows that what else is written leaves the record's numbers as they are.
own_copy: Any = intrinsic(_own_copy)


def own_array(*shape: int) -> Any:
    """Return a function for compiled code that returns an array of floats on the stack of the kernel, not filled, of this shape."""

    def _own_array(typingctx: Any) -> Any:
        kind = types.Array(types.float64, len(shape), "C")

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            with builder.goto_entry_block():
                place = builder.alloca(ir.ArrayType(ir.DoubleType(), math.prod(shape)))
            size = context.get_constant(types.intp, 8)
            array = context.make_array(kind)(context, builder)
            sides = [context.get_constant(types.intp, side) for side in shape]
            strides = [context.get_constant(types.intp, 8 * math.prod(shape[i + 1 :])) for i in range(len(shape))]
            data = builder.bitcast(place, array.data.type)
            arrayobj.populate_array(array, data=data, shape=sides, strides=strides, itemsize=size, meminfo=None)
            return array._getvalue()

        return kind(), generate

    return intrinsic(_own_array)
