"""Where the piston is behind a transmission that gives: its friction goes with its own speed, not with the joint's.

A deflection follows from the force that is carried. Play does not: while it is open the piston goes where gas and friction take it, and
nothing that was recorded says how fast. The balance is not judged there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.subsystems.motion.smoothing import reach, smoothing_width
from exo_sim.physics.transmission import plays, stiffness
from exo_sim.recording.filters import restored

Array = NDArray[np.float64]


def at_piston(run: MotionRun, cylinder: NDArray[np.void] | None) -> MotionRun:
    """Return a run whose motion is that of its piston, not judged while play may be open.

    Args:
        run: A balance of forces.
        cylinder: Record of the cylinder that drives it, shape (1,), whose transmission gives; None where none does.
    """
    if cylinder is None:
        return run
    carried = (run.demand - run.external) / run.drive.divisor
    ahead = restored(run.time, carried, smoothing_width(run.time, run.smoothing)) / float(stiffness(cylinder[0]))
    path = run.kinematics
    there = replace(path, position=path.position + ahead, velocity=path.velocity + np.gradient(ahead, run.time))
    known = run.judged & ~_open(run, carried) if plays(cylinder[0]) else run.known
    return replace(run, kinematics=there, known=known)


def _open(run: MotionRun, carried: Array) -> NDArray[np.bool_]:
    """Return where play may be open: about every reversal of what is carried, as far as the filter of the balance spreads it.

    While play is open nothing is carried, and the noise of a balance reverses what is hardly anything many times.

    Args:
        run: The balance.
        carried: Of its samples [N], shape (n,).
    """
    negative = np.signbit(carried)
    reversed_ = np.diff(negative, prepend=negative[:1])
    if not reversed_.any():
        return np.zeros_like(reversed_)
    return np.asarray(binary_dilation(reversed_, iterations=reach(run.time, run.smoothing)))
