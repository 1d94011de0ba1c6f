"""How fast a design's cylinders can follow forces as large as the task asks for, beside how fast the task's forces change."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.bandwidth import bandwidth, response
from exo_sim.control.valve_control import MODEL
from exo_sim.rig import Rig
from exo_sim.simulation.walk import Walk

#: Frequencies at which the response is worked out [Hz]; a gait's forces lie below the middle of them.
FREQUENCIES = np.geomspace(2.0, 40.0, 7)
#: Share of the demand's power about its mean that lies below the frequency which counts as needed.
NEEDED = 0.95


@dataclass(frozen=True)
class ForceBandwidth:
    """One cylinder.

    Attributes:
        name: Of the cylinder.
        amplitude: Half of the range of force that the walk demands of it [N].
        hertz: Lowest frequency at which a sine of that amplitude comes 3 dB down or 90 degrees late, the piston held at mid-stroke; the
            largest of `FREQUENCIES` where it follows all of them.
        needed: Frequency below which `NEEDED` of the demand's power lies [Hz].
    """

    name: str
    amplitude: float
    hertz: float
    needed: float

    @property
    def words(self) -> str:
        """Return how fast it follows, in words."""
        return f"{self.hertz:.0f} Hz" + (" and more" if self.hertz >= FREQUENCIES[-1] else "")


def force_bandwidths(walk: Walk, cylinders: tuple[str, ...]) -> tuple[ForceBandwidth, ...]:
    """Return what some cylinders of a walk can follow; valves move both chambers with one command, whatever their kind.

    Args:
        walk: Whole cycles of it count, the last ones.
        cylinders: Their names.
    """
    count = round(walk.motion.period / walk.step)
    last = slice(-count * max((len(walk.time) - 1) // count, 1), None)
    found = []
    for name in cylinders:
        demand = walk.columns[f"{name}.force_demanded"][last]
        amplitude = 0.5 * float(np.ptp(demand))
        if amplitude <= 0.0:
            continue
        values = response(_four_way(walk.rig, name), name, MODEL, FREQUENCIES, amplitude)
        hertz = bandwidth(FREQUENCIES, values)
        found.append(ForceBandwidth(name, amplitude, float(FREQUENCIES[-1]) if np.isnan(hertz) else hertz, needed(demand, walk.step)))
    return tuple(found)


def needed(demand: NDArray[np.float64], step: float) -> float:
    """Return the frequency below which `NEEDED` of a signal's power about its mean lies [Hz]; samples `step` [s] apart."""
    power = np.abs(np.fft.rfft(demand - demand.mean())) ** 2
    if power.sum() <= 0.0:
        return 0.0
    at = int(np.searchsorted(np.cumsum(power), NEEDED * power.sum()))
    return float(np.fft.rfftfreq(len(demand), step)[at])


def _four_way(rig: Rig, name: str) -> Rig:
    cylinder = rig.cylinders[name]
    plain = replace(cylinder, valve=replace(cylinder.valve, independent=False))
    return replace(rig, cylinders={**rig.cylinders, name: plain}, recovery=None)
