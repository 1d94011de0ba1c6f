"""Compiled functions that, where compiled code calls them, are linked into it and nothing else.

numba optimises each function that it compiles and makes machine code of it before it links it into its callers, where both are done
anew: a function eight calls deep is optimised eight times. The step of the gas is deep and inlined throughout; linked only, it compiles in
half the time and runs as fast.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numba
from numba import types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.extending import typeof_impl


class _Unnamed:
    """Where numba leaves what a function needs of Python when it raises or prints: a kernel does neither."""

    def set_env(self, name: str, env: object) -> None:
        """Leave nothing: there is no machine code that would look for it."""


class _LinkedOnly(JITCodeLibrary):  # type: ignore[misc]
    """Code as it is before its optimisation, with that of all that it calls."""

    codegen = _Unnamed()

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0, which says that there is no machine code; what is to be linked in is linked."""
        self._ensure_finalized()
        return 0

    def _optimize_final_module(self) -> None:
        """Leave that to what it is linked into."""

    def _finalize_final_module(self) -> None:
        self._finalized = True


class _Linking(Compiler):  # type: ignore[misc]
    """numba's compiler, its result to be linked only."""

    def __init__(self, typingctx: Any, targetctx: Any, library: Any, *others: Any) -> None:
        super().__init__(typingctx, targetctx, library or _LinkedOnly(targetctx.codegen(), __name__), *others)


class LinkedKernel:
    """A function of numbers, arrays and records that compiled code has inlined, and Python calls as machine code of its own.

    numba is asked for either when it is wanted: what is taken from the kept code has all of it inlined already.

    Args:
        function: The function.
        kernel: Compiles it to be called from Python.
        options: How numba compiles it.
    """

    def __init__(self, function: Callable[..., Any], kernel: Callable[[Callable[..., Any]], Callable[..., Any]], **options: Any) -> None:
        functools.update_wrapper(self, function)
        self.py_func, self._kernel, self._options = function, kernel, options

    def __call__(self, *arguments: Any) -> Any:
        return self._own(*arguments)

    @functools.cached_property
    def _own(self) -> Callable[..., Any]:
        return self._kernel(self.py_func)

    @functools.cached_property
    def linked(self) -> Any:
        """Numba's dispatcher where compiled code calls it."""
        compiler: Any = numba.njit
        return compiler(
            forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, pipeline_class=_Linking, **self._options
        )(self.py_func)  # fmt: skip


@typeof_impl.register(LinkedKernel)
def _type_of(value: LinkedKernel, context: object) -> Any:
    return types.Dispatcher(value.linked)
