"""A demand that is bettered from stride to stride by what load cells in the straps measured.

The calibration says which strap forces belong to which phase. Where a stride's forces were others, because the payload, the wearer, the
cadence or the harness is another, the least-squares gain of `least_load` says which change of the torques' harmonics takes the loads on
the wearer's joints back (norm-optimal iterative learning control, Amann, Owens and Rogers 1996). It uses strides that are over, and so is
causal.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.least_load import LeastLoad
from exo_sim.control.stride_means import StrideMeans

#: Share of a full correction that one stride makes. Of 0.1, 0.2 and 0.3 with six rows of docs/walking.md in sight (longer right step: 147,
#: 146 and 145 J a stride, an early phase: 157, 155 and 154; by the demand of that day). Of 0.2 and 0.3 with
#: the machine at 9 bar and a demand that was chosen (`simulation/demand_choice.py`) a late phase took 143 and 150 J, straps half as stiff
#: 141 and 151 J.
_SHARE = 0.2


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
        self._change = self._plan.restored(self._change, forces - self._usual, _SHARE)
        self.table = self._plan.table(self._plan.best + self._change)
