"""Residuals that were predicted already: fits begin where others ended, and are compared there."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.parameters import PlantParameters

Array = NDArray[np.float64]
#: World, cylinder and sensors of a plant.
_Key = tuple[bytes, bytes, tuple[tuple[str, float], ...]]

#: Residuals are kept up to so many bytes together.
MOST_BYTES = 16_000_000


class KeptResiduals:
    """The latest residuals of one model, by plant."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._kept: OrderedDict[_Key, Array] = OrderedDict()
        self._bytes = 0

    def of(self, plant: PlantParameters, predict: Callable[[PlantParameters], Array]) -> Array:
        """Return the residual of a plant, which nobody may write to; shape (n,), as `predict` returns it."""
        key = plant.world.tobytes(), plant.cylinder.tobytes(), tuple(sorted(plant.sensors.items()))
        with self._lock:
            if key in self._kept:
                self._kept.move_to_end(key)
                return self._kept[key]
        residual = predict(plant)
        residual.flags.writeable = False
        with self._lock:
            if key not in self._kept:
                self._kept[key] = residual
                self._bytes += residual.nbytes
            while self._bytes > MOST_BYTES:
                self._bytes -= self._kept.popitem(last=False)[1].nbytes
        return residual
