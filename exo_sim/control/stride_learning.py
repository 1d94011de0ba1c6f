"""A demand that is bettered from stride to stride by what load cells in the straps measured.

The calibration says which strap forces belong to which phase. Where a stride's forces were others, because the payload, the wearer, the
cadence or the harness is another, the least-squares gain of `least_load` says which change of the torques' harmonics takes the loads on
the wearer's joints back (norm-optimal iterative learning control, Amann, Owens and Rogers 1996). The mean push ahead, by which the wearer
pulls the machine like a sledge, is known whatever the phase is: it is taken back faster, by what costs his joints least. Strides are used
that are over, and so it is causal.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.least_load import LeastLoad
from exo_sim.control.stride_means import StrideMeans
from exo_sim.deciding_number import Number

#: Share of a full correction that one stride makes. Of 0.1, 0.2 and 0.3 with six rows of docs/walking.md in sight (longer right step: 147,
#: 146 and 145 J a stride, an early phase: 157, 155 and 154; by the demand of that day). Of 0.2 and 0.3 with
#: the machine at 9 bar and a demand that was chosen (`simulation/demand_choice.py`) a late phase took 143 and 150 J, straps half as stiff
#: 141 and 151 J.
_SHARE = 0.2
OF_PUSH = Number(
    0.4, "of the push", "what one stride takes off the mean push ahead beside that",
    "rows of docs/walking.md with 0, 0.2, 0.4 and 0.6: 27, 21, 16 and 12 N where the phase is late and not corrected, 29, 18, 11 and 7 N "
    "on straps half as stiff, for 532, 536, 541 and 544 W, and 520, 523, 525 and 526 W (commit 48dee7f4; backpack 556 W); with the demand "
    "of today 12, 10 and 8 N, and 1 N, with 0, 0.2 and 0.4, for no more power",
)  # fmt: skip


class StrideLearning:
    """The demand of the calibration and what was learnt since.

    Args:
        plan: As it was rehearsed.
        forces: On the machine, of each strap across and along its segment, at PHASES even phases of the calibration [N],
            shape (PHASES, 2 straps).
    """

    def __init__(self, plan: LeastLoad, forces: NDArray[np.float64]) -> None:
        self._plan, self._usual = plan, forces
        self._change = np.zeros_like(plan.best)
        self._pushing = plan.pushing()
        self._means = StrideMeans(forces.shape[1])
        self.forget()

    def forget(self) -> None:
        """Begin with the demand of the calibration."""
        self._change[:] = 0.0
        self._means.forget()
        self.table = self._plan.table(self._plan.best)

    def take(self, phase: float, forces: NDArray[np.float64]) -> None:
        """Take in the strap forces at a phase, whole strides counted on; learn where a stride is over."""
        over = self._means.take(phase, forces)
        if over is not None:
            self._learn(over)

    def _learn(self, forces: NDArray[np.float64]) -> None:
        off = forces - self._usual
        asked = self._change - OF_PUSH * self._plan.push(off) * self._pushing
        self._change = self._plan.restored(asked, off, _SHARE)
        self.table = self._plan.table(self._plan.best + self._change)
