"""The force that a balance lacks, for given parameters; of a long recording only around what is fitted."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.healthy_leak import OUTWARD
from exo_sim.diagnosis.subsystems.motion.resistance import resistance_along
from exo_sim.diagnosis.subsystems.motion.rows import Rows
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothed_alike
from exo_sim.physics.records import CYLINDER
from exo_sim.recording.filters import EvenClock

Array = NDArray[np.float64]

#: So many forces of resistance are kept of each run: what sensors add to a balance is asked of one and the same.
RESISTANCES = 8
#: Before and behind what is fitted of a long recording so much is predicted [s]: a contact then slides as if it had from the beginning,
#: and the filter meets no end.
MARGIN = 1.0


class LackingForce:
    """What the balance of one run lacks.

    Args:
        run: The balance.
    """

    def __init__(self, run: MotionRun):
        self.run, self._clock = run, EvenClock.of(run.time)
        self._resisted = lru_cache(maxsize=RESISTANCES)(self._resistance)

    def of(self, plant: PlantParameters) -> Array:
        """Return the force that is lacking at every sample [N or N m], shape (n,)."""
        run, sensors = self.run, plant.sensors
        inertia, passive = run.inertia, run.passive
        resisted = self._resisted(plant.cylinder.tobytes())
        mass = sensors.get("payload_mass", 1.0)
        moved = (
            inertia.force
            + (sensors.get("inertia", 1.0) - 1.0) * (inertia.force - inertia.bias)
            + sensors.get("zero", 0.0) * inertia.tilt
        )
        exerted = passive.force if passive.damping is None else passive.force + (sensors.get("damping", 1.0) - 1.0) * passive.damping
        found = mass * moved - exerted - run.drive.force - run.external + resisted - sensors.get("offset", 0.0)
        for column, lever in run.drive.levers.items():
            found = found + lever * sensors.get(f"{column}.bias", 0.0)
        for column, signal in run.drive.signals.items():
            scale = sensors.get(f"{column}.scale", 1.0)
            if scale != 1.0:
                found = found + run.drive.levers[column] * signal * (1.0 - 1.0 / scale)
        late = sensors.get("drive.delay", 0.0)
        if late != 0.0:
            found = found - late * np.gradient(run.drive.force + run.external, run.time)
        if run.imputed is not None:
            for name, response in run.imputed.uncertain.items():
                found = found - response * sensors.get(name, 0.0)
            for name, response in run.imputed.leaks.items():
                found = found - response * float(plant.cylinder[OUTWARD.name][name][0])
        return found

    def _resistance(self, cylinder: bytes) -> Array:
        """Return what resists the motion behind the filter of the balance, for the bytes of a record CYLINDER, shape (n,)."""
        run, resisted = self.run, np.empty(len(self.run.time))
        path, record = run.kinematics, np.frombuffer(cylinder, CYLINDER)
        resistance_along(record[0], run.time, path.position, path.velocity, run.drive.gauge, resisted)
        found = smoothed_alike(run.time, run.drive.arm * resisted, self._clock)  # neither side of it steps at a reversal
        found.flags.writeable = False
        return found


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
