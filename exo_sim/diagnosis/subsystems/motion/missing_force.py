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
from exo_sim.diagnosis.nominal_numbers import DRIVE_DELAY, FORCE_OFFSET, PAYLOAD_MASS
from exo_sim.diagnosis.subsystems.healthy_leak import OUTWARD
from exo_sim.diagnosis.subsystems.motion.onsets import Onsets
from exo_sim.diagnosis.subsystems.motion.resistance import resistance_along, resistance_starting
from exo_sim.diagnosis.subsystems.motion.rows import Rows
from exo_sim.diagnosis.subsystems.motion.smoothing import before_filter, smoothed_alike
from exo_sim.physics.plant_records import CYLINDER
from exo_sim.recording.filters import EvenClock

Array = NDArray[np.float64]

#: So many forces of resistance are kept of each run: what sensors add to a balance is asked of one and the same.
RESISTANCES = 8
#: Before and behind what is fitted of a long recording so much is predicted [s]: a contact then slides as if it had from the beginning,
#: and the filter meets no end. It decides nothing but how long that takes: over the same six recordings rows differ from those of a whole
#: prediction by 3e-13 of their noise at most.
MARGIN = 1.0
#: So many samples at least are beside the rows when the filter is formed for them: several of its widths on any clock.
FEWEST_IN_MARGIN = 500


@dataclass(frozen=True)
class Terms:
    """What a balance consists of, but for what resists the motion: at every sample, or as means of rows, shape (k,) each.

    Attributes:
        force, bias, tilt, carried: As of `Inertia`; the last may be None.
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
    carried: Array | None
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

        def all_of(signals: Mapping[str, Array]) -> dict[str, Array]:
            return {name: each(values) for name, values in signals.items()}

        return cls(
            each(inertia.force), each(inertia.bias), each(inertia.tilt),
            None if inertia.carried is None else each(inertia.carried), each(passive.force),
            None if passive.damping is None else each(passive.damping), each(drive.force), each(run.external),
            each(np.gradient(drive.force + run.external, run.time)), all_of(drive.levers),
            {column: each(drive.levers[column] * signal) for column, signal in drive.signals.items()},
            all_of(imputed.uncertain if imputed else {}), all_of(imputed.leaks if imputed else {}),
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
        mass = sensors.get(PAYLOAD_MASS, 1.0)
        moved = mass * moved if self.carried is None else moved + (mass - 1.0) * self.carried
        found = moved - exerted - self.drive - self.external + resisted - sensors.get(FORCE_OFFSET, 0.0)
        for column, lever in self.levers.items():
            found = found + lever * sensors.get(f"{column}.bias", 0.0)
        for column, signal in self.signals.items():
            scale = sensors.get(f"{column}.scale", 1.0)
            if scale != 1.0:
                found = found + signal * (1.0 - 1.0 / scale)
        late = sensors.get(DRIVE_DELAY, 0.0)
        if late != 0.0:
            found = found - late * self.rate
        for name, response in self.uncertain.items():
            found = found - response * sensors.get(name, 0.0)
        for name, response in self.leaks.items():
            found = found - response * float(plant.cylinder[OUTWARD.name][name][0])
        return found


class MissingForce:
    """What the balance of one run lacks.

    Args:
        run: The balance.
    """

    def __init__(self, run: MotionRun):
        self.run = run
        self._resisted = lru_cache(maxsize=RESISTANCES)(_Resistance(run).filtered)

    @cached_property
    def _terms(self) -> Terms:
        return Terms.of(self.run)

    def of(self, plant: PlantParameters) -> Array:
        """Return the force that is lacking at every sample [N or N m], shape (n,)."""
        return self._terms.lacking(self._resisted(plant.cylinder.tobytes()), plant)


class MissingRows:
    """What the balance of one run lacks, as the means of its rows.

    Args:
        run: The balance.
        rows: Its rows, one at least.
    """

    def __init__(self, run: MotionRun, rows: Rows):
        self.run, self._rows = run, rows
        self._resisted = lru_cache(maxsize=RESISTANCES)(_ResistanceOfRows(run, rows).means)

    @cached_property
    def _terms(self) -> Terms:
        return Terms.of(self.run, self._rows.means)

    def of(self, plant: PlantParameters) -> Array:
        """Return the mean of what is lacking over each row [N or N m], shape (m,)."""
        return self._terms.lacking(self._resisted(plant.cylinder.tobytes()), plant)


class MissingOnsets:
    """What the balance of one run lacks at its onsets, where a contact has just begun to slide, whatever it did before.

    Args:
        run: The balance.
        onsets: Its onsets.
    """

    def __init__(self, run: MotionRun, onsets: Onsets):
        self._onsets, self._arm, path = onsets, onsets.means(run.drive.arm), run.kinematics
        self._terms = Terms.of(run, onsets.means)
        self._position, self._gauge = onsets.means(path.position), onsets.means(run.drive.gauge)

    def of(self, plant: PlantParameters) -> Array:
        """Return what is lacking at each onset [N or N m], shape (k,)."""
        one, resisted = self._onsets, np.empty(len(self._arm))
        resistance_starting(
            plant.cylinder[0], self._position, self._gauge, one.way * one.slowest, one.acceleration, one.fastest, one.rate, one.width,
            one.damping, resisted,
        )  # fmt: skip
        return self._terms.lacking(self._arm * (resisted + one.damped), plant) + one.noise


class _Resistance:
    """What resists the motion of one run, for the bytes of a record CYLINDER [N or N m]."""

    def __init__(self, run: MotionRun):
        self.run, self.clock = run, EvenClock.of(run.time)

    def filtered(self, cylinder: bytes) -> Array:
        """Return it at every sample behind the filter of the balance, shape (n,)."""
        found = smoothed_alike(self.run.time, self.at_samples(cylinder, len(self.run.time)), self.clock, self.run.smoothing)
        found.flags.writeable = False
        return found

    def at_samples(self, cylinder: bytes, count: int) -> Array:
        """Return it at the first `count` samples: neither side of a balance steps at a reversal behind the filter."""
        run, path, resisted = self.run, self.run.kinematics, np.empty(count)
        record = np.frombuffer(cylinder, CYLINDER)[0]
        resistance_along(record, run.time[:count], path.position[:count], path.velocity[:count], run.drive.gauge[:count], resisted)
        return run.drive.arm[:count] * resisted


class _ResistanceOfRows:
    """The same as means of rows."""

    def __init__(self, run: MotionRun, rows: Rows):
        self._samples, self._rows = _Resistance(run), rows
        usual, compared = self._samples.clock.usual, np.flatnonzero(rows.compared)
        margin = max(int(MARGIN / usual), FEWEST_IN_MARGIN)
        self._part = slice(max(int(compared[0]) - margin, 0), min(int(compared[-1]) + 1 + margin, len(run.time)))

    @cached_property
    def _weights(self) -> sparse.csr_array:
        """What rows take from the unfiltered samples of the part that they need, shape (m, k)."""
        time, clock = self._samples.run.time[self._part], self._samples.clock
        even = clock.even
        if even is not None:
            even = even[slice(*np.searchsorted(even, (time[0], np.nextafter(time[-1], np.inf))))]
        return before_filter(self._rows.weights()[:, self._part], time, EvenClock(clock.usual, even), self._samples.run.smoothing)

    def means(self, cylinder: bytes) -> Array:
        """Return the mean over each row, shape (m,)."""
        resisted = self._samples.at_samples(cylinder, self._part.stop)[self._part]
        if not np.isfinite(resisted).all():  # the filter bridges what is missing
            return self._rows.means(self._samples.filtered(cylinder))
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
