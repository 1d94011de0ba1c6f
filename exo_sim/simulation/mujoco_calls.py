"""Calling MuJoCo's C functions from compiled loops, by address: such a loop can be cached."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import mujoco
from llvmlite import ir
from numba import types
from numba.extending import intrinsic


def _call(typingctx: Any, function: Any, model: Any, data: Any) -> Any:
    """Call `void function(mjModel*, mjData*)`; all three are addresses. An `mju_error` inside ends the process."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer = ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [pointer, pointer])
        target = builder.inttoptr(arguments[0], kind.as_pointer())
        builder.call(target, [builder.inttoptr(argument, pointer) for argument in arguments[1:]])
        return context.get_dummy_value()

    return types.void(types.int64, types.int64, types.int64), generate


#: `call(function, model, data)` in compiled code.
call: Any = intrinsic(_call)


def _read_time(typingctx: Any, function: Any, model: Any, data: Any, out: Any) -> Any:
    """Call `mj_getState` for the time alone; all four are addresses."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, whole = ir.IntType(8).as_pointer(), ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [pointer, pointer, pointer, whole])
        target = builder.inttoptr(arguments[0], kind.as_pointer())
        places = [builder.inttoptr(argument, pointer) for argument in arguments[1:]]
        builder.call(target, [*places, ir.Constant(whole, int(mujoco.mjtState.mjSTATE_TIME))])
        return context.get_dummy_value()

    return types.void(types.int64, types.int64, types.int64, types.int64), generate


#: `read_time(mj_getState, model, data, out)` in compiled code: writes `data.time` to an address.
read_time: Any = intrinsic(_read_time)


def _library() -> ctypes.CDLL:
    folder = Path(mujoco.__file__).parent
    for pattern in ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll"):
        for path in sorted(folder.glob(pattern)):
            return ctypes.CDLL(str(path))
    raise ImportError(f"MuJoCo's library is not in {folder}")


_LIBRARY = _library()


def address(function: str) -> int:
    """Return the address of a function of MuJoCo's library."""
    pointer = ctypes.cast(getattr(_LIBRARY, function), ctypes.c_void_p).value
    assert pointer is not None
    return pointer


@contextmanager
def warnings_counted() -> Iterator[None]:
    """Let MuJoCo count its warnings in `data.warning` without printing them, and without a MUJOCO_LOG.TXT."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda message: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
