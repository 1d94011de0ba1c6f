"""How the truths' kernels are compiled and where their machine code is kept.

numba does not notice an edit in another file that a cached function calls, so the folder of the cache is named after the text of all
kernels of a truth. Each truth keeps its own; they share no code with what they try.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, TypeVar, cast

import numba
from numba.core import config

Function = TypeVar("Function", bound=Callable[..., Any])


def compiler(truth: Path, divides_by_zero: bool) -> Callable[[Function], Function]:
    """Return what compiles functions of a truth for scalars, arrays and machine records, and keeps their machine code.

    Args:
        truth: The folder of its files; those with kernels, or with the fields of its records, name the cache.
        divides_by_zero: True where a division by zero gives infinity, False where it raises.
    """
    kept = str(_folder(truth))
    model: Literal["numpy", "python"] = "numpy" if divides_by_zero else "python"

    def kernel(function: Function) -> Function:
        settings: Any = config
        before = settings.CACHE_DIR
        settings.CACHE_DIR = kept
        try:
            compiled: Any = numba.njit(cache=True, nogil=True, error_model=model)(function)
        finally:
            settings.CACHE_DIR = before
        return cast("Function", compiled)

    return kernel


def _folder(truth: Path) -> Path:
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(truth.glob("*.py")):
        text = path.read_bytes()
        if b"@kernel" in text or b"FIELDS" in text:
            digest.update(text)
    root = os.environ.get("EXO_SIM_CACHE") or os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(root) / "exo-sim-trials" / digest.hexdigest()[:16]
