"""Results along a motion that were worked out already: rigs that are held against one recording mostly have the same masses."""

from __future__ import annotations

import hashlib
import pickle
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from threading import Lock
from typing import Any, Generic, TypeVar

import mujoco
import numpy as np

Result = TypeVar("Result")

#: Results that are kept, and the bytes up to which all of them together are: an hour's dynamics are asked for once.
MOST, MOST_BYTES = 4, 32_000_000


class KeptDynamics(Generic[Result]):
    """The latest results, by machine and motion; nobody may write to them."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._kept: OrderedDict[bytes, Result] = OrderedDict()

    def of(self, model: mujoco.MjModel, along: tuple[Any, ...], work_out: Callable[[], Result]) -> Result:
        """Return what `work_out` returns, or returned before for this.

        Args:
            model: The machine: everything that MuJoCo knows of it counts.
            along: All that the result depends on besides: what pickles to the same bytes is the same.
            work_out: Makes it.
        """
        key = _digest(model, along)
        with self._lock:
            if key in self._kept:
                self._kept.move_to_end(key)
                return self._kept[key]
        result = work_out()
        with self._lock:
            self._kept[key] = result
            while len(self._kept) > MOST or sum(map(_bytes_of, self._kept.values())) > MOST_BYTES:
                self._kept.popitem(last=False)
        return result


def _bytes_of(result: Any) -> int:
    """Return how much the arrays of a result take, those of records in it too."""
    if isinstance(result, np.ndarray):
        return int(result.nbytes)
    return sum(_bytes_of(getattr(result, one.name)) for one in fields(result)) if is_dataclass(result) else 0


def _digest(model: mujoco.MjModel, along: tuple[Any, ...]) -> bytes:
    machine = np.empty(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, machine)
    found = hashlib.blake2b(machine.tobytes())
    found.update(pickle.dumps(along, protocol=5))
    return found.digest()
