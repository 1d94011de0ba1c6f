"""How this truth's kernels are compiled and where their machine code is kept.

numba does not notice an edit in another file that a cached function calls, so the folder of the cache is named after the text of
all kernels here. The other rooms' kernels keep their own folders: this truth shares no code with what it tries.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import config

Function = TypeVar("Function", bound=Callable[..., Any])


def _folder() -> Path:
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        text = path.read_bytes()
        if b"@kernel" in text or b"FIELDS" in text:
            digest.update(text)
    root = os.environ.get("EXO_SIM_CACHE") or os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(root) / "exo-sim-trials" / digest.hexdigest()[:16]


_FOLDER = _folder()


def kernel(function: Function) -> Function:
    """Compile a function for scalars, arrays and machine records, and keep its machine code."""
    settings: Any = config
    before = settings.CACHE_DIR
    settings.CACHE_DIR = str(_FOLDER)
    try:
        compiled: Any = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    finally:
        settings.CACHE_DIR = before
    return cast("Function", compiled)
