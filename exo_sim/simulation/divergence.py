"""What ends a simulation: a warning of MuJoCo, a number that is none, a piston far from its cylinder, a machine that leaves its wearer."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import Diverged
from exo_sim.gait.motion import Motion

Array = NDArray[np.float64]

#: How far the machine may leave its wearer before the run counts as a fall [rad, m].
_FALLEN_PITCH, _FALLEN_DISTANCE = 0.7, 0.35
#: The quick look at one row calls the exact one from this share of those limits on.
_NEAR = 0.9


def check_numbers(data: mujoco.MjData, rows: Array, keys: Sequence[str], name: str, when: str, advice: str) -> None:
    """Refuse warnings of MuJoCo and numbers that are none.

    Args:
        data: After the last of the steps.
        rows: What was logged, shape (n, m).
        keys: What the columns are, m of them.
        name, when, advice: Words of the message: of what, at which time, what to do.

    Raises:
        Diverged: there is one.
    """
    if data.warning.number.any():
        kind = list(mujoco.mjtWarning.__members__)[int(np.argmax(data.warning.number > 0))]
        raise Diverged(f"{name}: MuJoCo warns of {kind} {when}; {advice}")
    finite = np.isfinite(rows).all(axis=0)
    if not finite.all():
        raise Diverged(f"{name}: {keys[int(np.argmin(finite))]} is not a number {when}; {advice}")


def check_strokes(rows: Array, keys: Sequence[str], strokes: Mapping[str, float], name: str, when: str, advice: str) -> None:
    """Refuse pistons farther outside their strokes than these are long: the stops of their joints hold them no more.

    Args:
        rows, keys, name, when, advice: As of `check_numbers`; `<cylinder>.length` counts from the end where the rod is fully in [m].
        strokes: By cylinder [m].

    Raises:
        Diverged: there is one.
    """
    for cylinder, stroke in strokes.items():
        outside = np.abs(rows[:, keys.index(f"{cylinder}.length")] - 0.5 * stroke) - 0.5 * stroke
        if outside.max() > stroke:
            far = f"{1e3 * outside.max():.4g} mm outside its stroke of {1e3 * stroke:g} mm"
            raise Diverged(f"{name}: the piston of {cylinder} is {far} {when}; {advice}")


@dataclass(frozen=True)
class WearerWatch:
    """Whether the rows of a log are of a machine that is on its wearer.

    Attributes:
        name: Of the scenario.
        data: Of MuJoCo.
        motion: Of the wearer.
        step: Of the simulation [s].
        keys: What the columns of the log are, the time first; places and pitch of the torso behind it.
    """

    name: str
    data: mujoco.MjData
    motion: Motion
    step: float
    keys: tuple[str, ...]

    def check(self, rows: Array, start: int) -> None:
        """Refuse what cannot be in rows of the log, shape (n, len(keys)), the first of which is that of step `start`.

        Raises:
            Diverged: a warning of MuJoCo, a number that is none, or a machine that left its wearer.
        """
        stop = start + len(rows)
        when = f"at {start * self.step:.3f} to {stop * self.step:.3f} s"
        advice = "try a shorter timestep in the MJCF, a smaller payload, or --assist vented to find the cause"
        check_numbers(self.data, rows, self.keys, self.name, when, advice)
        cycles = np.arange(start, stop, dtype=np.float64) * (self.step / self.motion.period)
        wanted = self.motion.at(cycles, 3)
        far = np.hypot(rows[:, 1] - wanted[:, 0] - self.motion.advance * cycles, rows[:, 2] - wanted[:, 1] - self.motion.climb * cycles)
        if far.max() > _FALLEN_DISTANCE or np.abs(rows[:, 3] - wanted[:, 2]).max() > _FALLEN_PITCH:
            raise Diverged(f"{self.name}: the machine falls away from its wearer {when}; {advice}")

    def sound(self, row: Array, step: int) -> bool:
        """Return whether one row of the log is of a machine that is on its wearer: a quick look, `check` says what is wrong."""
        if self.data.warning.number.any() or not np.isfinite(row).all():
            return False
        cycles = step * self.step / self.motion.period
        samples = len(self.motion.position)
        x, z, pitch = self.motion.position[int(cycles * samples) % samples, :3].tolist()
        far = math.hypot(row[1] - x - self.motion.advance * cycles, row[2] - z - self.motion.climb * cycles)
        return far < _NEAR * _FALLEN_DISTANCE and abs(row[3] - pitch) < _NEAR * _FALLEN_PITCH
