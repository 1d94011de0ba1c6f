"""How late the estimated phase is, from what load cells in the straps showed over a stride.

Encoders show where the machine's joints are, and an observer of them may be late or early throughout. Strap forces tell: where the
estimated phase is late by d strides, each force comes d strides before the phase that it belongs to, and so do all its causes but the
torques, which come at the estimated phase. To first order forces are off by

    d (d force/d phase - R d torque/d phase) + R (torque applied - torque of the calibration)

with R from torques to strap forces (`least_load`). So after each stride d follows by least squares, and a share of it corrects the phase.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.least_load import LeastLoad
from exo_sim.control.machine_dynamics import PICK
from exo_sim.control.stride_means import StrideMeans
from exo_sim.gait.motion import derivatives

#: Share of what a stride shows that corrects the phase, and the most that it is corrected by [strides].
_SHARE, _MOST = 0.3, 0.1


class PhaseCorrection:
    """What is added to an estimated phase, learnt from stride to stride.

    Args:
        plan: As it was rehearsed.
        forces: On the machine, of each strap across and along its segment, at PHASES even phases of the calibration [N],
            shape (PHASES, 2 straps).

    Attributes:
        added: To the phase [strides].
    """

    def __init__(self, plan: LeastLoad, forces: NDArray[np.float64]) -> None:
        self._plan, self._usual = plan, forces
        self._torques = plan.table(plan.best)[PICK][:, plan.driven]
        self._off = derivatives(forces)[0] - plan.strap_forces(derivatives(self._torques)[0])
        self._means = StrideMeans(forces.shape[1] + len(plan.driven))
        self.forget()

    def forget(self) -> None:
        """Begin with the phase as it is estimated."""
        self.added = 0.0
        self._means.forget()

    def take(self, phase: float, forces: NDArray[np.float64], torques: NDArray[np.float64]) -> None:
        """Take in strap forces [N] and the torques asked of the driven joints [N m] at a phase, whole strides counted on."""
        over = self._means.take(phase, np.concatenate([forces, torques]))
        if over is not None:
            late = self.late(*np.split(over, [len(forces)], axis=1))
            self.added = float(np.clip(self.added + _SHARE * late, -_MOST, _MOST))

    def late(self, forces: NDArray[np.float64], torques: NDArray[np.float64]) -> float:
        """Return how late the phase was [strides] for a stride's strap forces, shape (PHASES, 2 straps), and torques, (PHASES, driven)."""
        off = forces - self._usual - self._plan.strap_forces(torques - self._torques)
        return float((self._off * off).sum() / (self._off**2).sum())
