"""pyarrow without pandas: the first list that is made an array has it import pandas, which takes longer than writing a walk."""

from __future__ import annotations

import sys
import threading
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from types import ModuleType


def settle() -> None:
    """Let pyarrow ask for pandas now, and find none in this thread, where nobody has imported it yet.

    It asks once for arrays; what it makes for pandas (`to_pandas`) asks again, and gets it.
    """
    import pyarrow as pa

    if "pandas" in sys.modules:
        return
    none = _NoPandas(threading.get_ident())
    sys.meta_path.insert(0, none)
    try:
        pa.array([0])
    finally:
        sys.meta_path.remove(none)


class _NoPandas(MetaPathFinder):
    """Finds that there is no pandas, for one thread."""

    def __init__(self, thread: int) -> None:
        self._thread = thread

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> None:
        if name == "pandas" and threading.get_ident() == self._thread:
            raise ModuleNotFoundError("no pandas for arrays", name=name)
