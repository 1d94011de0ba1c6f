"""The force that a balance lacks, for given parameters: at every sample, or as the means of its rows.

All of it but what resists the motion is linear in the parameters. Of each term, and of the filter, the rows are formed once; a search asks
thousands of times.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.healthy_leak import OUTWARD
from exo_sim.diagnosis.subsystems.motion.resistance import resistance_along
from exo_sim.diagnosis.subsystems.motion.rows import Rows
from exo_sim.diagnosis.subsystems.motion.smoothing import before_filter, smoothed_alike
from exo_sim.physics.records import CYLINDER
from exo_sim.recording.filters import EvenClock

Array = NDArray[np.float64]

#: So many forces of resistance are kept of each run: what sensors add to a balance is asked of one and the same.
RESISTANCES = 8
#: Before and behind what is fitted of a long recording so much is predicted [s]: a contact then slides as if it had from the beginning,
#: and the filter meets no end.
MARGIN = 1.0


@dataclass(frozen=True)
class Terms:
    """What a balance consists of, but for what resists the motion: at every sample, or as means of rows, shape (k,) each.

    Attributes:
        force, bias, tilt: As of `Inertia`.
        passive, damping: Of `Passive`; the latter may be None.
        drive, external: Forces that drive the motion.
        rate: Derivative of both together with respect to time.
        levers: By column, what a bias of it adds.
        signals: By column, what the balance takes from it.
        uncertain, leaks: Of `Imputed`; nothing where all pressures were measured.
    """

    force: Array
    bias: Array
    tilt: Array
    passive: Array
    damping: Array | None
    drive: Array
    external: Array
    rate: Array
    levers: Mapping[str, Array]
    signals: Mapping[str, Array]
    uncertain: Mapping[str, Array]
    leaks: Mapping[str, Array]

    @classmethod
    def of(cls, run: MotionRun, each: Callable[[Array], Array] = lambda values: values) -> Terms:
        """Return the terms of a run at its samples, or what `each` makes of them."""
        inertia, passive, drive, imputed = run.inertia, run.passive, run.drive, run.imputed

        def all_of(signals: Mapping[str, Array] | None) -> dict[str, Array]:
            return {name: each(values) for name, values in (signals or {}).items()}

        return cls(
            each(inertia.force), each(inertia.bias), each(inertia.tilt), each(passive.force),
            None if passive.damping is None else each(passive.damping), each(drive.force), each(run.external),
            each(np.gradient(drive.force + run.external, run.time)), all_of(drive.levers),
            {column: each(drive.levers[column] * signal) for column, signal in drive.signals.items()},
            all_of(imputed and imputed.uncertain), all_of(imputed and imputed.leaks),
        )  # fmt: skip

    def lacking(self, resisted: Array, plant: PlantParameters) -> Array:
        """Return the force that is lacking [N or N m], shape (k,).

        Args:
            resisted: What resists the motion, shape (k,).
            plant: The parameters.
        """
        sensors = plant.sensors
        moved = self.force + (sensors.get("inertia", 1.0) - 1.0) * (self.force - self.bias) + sensors.get("zero", 0.0) * self.tilt
        exerted = self.passive if self.damping is None else self.passive + (sensors.get("damping", 1.0) - 1.0) * self.damping
        mass = sensors.get("payload_mass", 1.0)
        found = mass * moved - exerted - self.drive - self.external + resisted - sensors.get("offset", 0.0)
        for column, lever in self.levers.items():
            found = found + lever * sensors.get(f"{column}.bias", 0.0)
        for column, signal in self.signals.items():
            scale = sensors.get(f"{column}.scale", 1.0)
            if scale != 1.0:
                found = found + signal * (1.0 - 1.0 / scale)
        late = sensors.get("drive.delay", 0.0)
        if late != 0.0:
            found = found - late * self.rate
        for name, response in self.uncertain.items():
            found = found - response * sensors.get(name, 0.0)
        for name, response in self.leaks.items():
            found = found - response * float(plant.cylinder[OUTWARD.name][name][0])
        return found


class LackingForce:
    """What the balance of one run lacks.

    Args:
        run: The balance.
    """

    def __init__(self, run: MotionRun):
        self.run, self.clock = run, EvenClock.of(run.time)
        self._resisted = lru_cache(maxsize=RESISTANCES)(self.resistance)

    @cached_property
    def _terms(self) -> Terms:
        return Terms.of(self.run)

    def of(self, plant: PlantParameters) -> Array:
        """Return the force that is lacking at every sample [N or N m], shape (n,)."""
        return self._terms.lacking(self._resisted(plant.cylinder.tobytes()), plant)

    def resistance(self, cylinder: bytes) -> Array:
        """Return what resists the motion behind the filter of the balance, for the bytes of a record CYLINDER, shape (n,)."""
        found = smoothed_alike(self.run.time, self.unfiltered(cylinder, len(self.run.time)), self.clock)
        found.flags.writeable = False
        return found

    def unfiltered(self, cylinder: bytes, count: int) -> Array:
        """Return what resists the motion at the first `count` samples: neither side of a balance steps at a reversal behind the filter."""
        run, path, resisted = self.run, self.run.kinematics, np.empty(count)
        record = np.frombuffer(cylinder, CYLINDER)[0]
        resistance_along(record, run.time[:count], path.position[:count], path.velocity[:count], run.drive.gauge[:count], resisted)
        return run.drive.arm[:count] * resisted


class LackingRows:
    """What the balance of one run lacks, as the means of its rows.

    Args:
        run: The balance.
        rows: Its rows.
    """

    def __init__(self, run: MotionRun, rows: Rows):
        self.run, self._rows, self._samples = run, rows, LackingForce(run)
        self._resisted = lru_cache(maxsize=RESISTANCES)(self._resistance)

    @cached_property
    def _terms(self) -> Terms:
        return Terms.of(self.run, self._rows.means)

    @cached_property
    def _weights(self) -> sparse.csr_array:
        """What rows take from the unfiltered samples, as far as they take any, shape (m, k)."""
        weights = before_filter(self._rows.weights(), self.run.time, self._samples.clock)
        return weights[:, : int(weights.indices.max()) + 1]

    def of(self, plant: PlantParameters) -> Array:
        """Return the mean of what is lacking over each row [N or N m], shape (m,)."""
        return self._terms.lacking(self._resisted(plant.cylinder.tobytes()), plant)

    def _resistance(self, cylinder: bytes) -> Array:
        resisted = self._samples.unfiltered(cylinder, self._weights.shape[1])
        if not np.isfinite(resisted).all():  # the filter bridges what is missing
            return self._rows.means(self._samples.resistance(cylinder))
        return np.asarray(self._weights @ resisted)


def around(run: MotionRun, rows: Rows) -> list[tuple[MotionRun, Rows]]:
    """Return the parts of a run that its rows need, each with those rows; together they are all rows, in their order."""
    compared = np.flatnonzero(rows.compared)
    if not compared.size:
        return []
    apart = np.flatnonzero(np.diff(run.time[compared]) > 3.0 * MARGIN)
    found = []
    for begin, end in zip(compared[[0, *(apart + 1)]], compared[[*apart, -1]], strict=True):
        start, stop = np.searchsorted(run.time, (run.time[begin] - MARGIN, run.time[end] + MARGIN))
        group = rows.group[start:stop]
        first, last = int(rows.group[begin]), int(rows.group[end]) + 1
        own = Rows(np.where(group >= 0, group - first, -1), rows.block[first:last], rows.scale[first:last])
        found.append((run.part(int(start), int(stop)), own))
    return found
