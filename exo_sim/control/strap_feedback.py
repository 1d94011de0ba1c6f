"""Interface-force feedback: joint torques at once against strap forces that do not belong to the phase.

From each strap's force follow its stretch and the rate of it, the strap being a spring beside a damper, and from all stretches where the
machine is beside its wearer. What to do about it is the periodic linear-quadratic regulator of the machine along its walk
(Bittanti, Colaneri and De Nicolao 1991, in "The Riccati Equation", Springer, chapter 6), its cost the loads on the wearer's joints, a lag
of the cylinders' force among its states.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.machine_dynamics import PHASES
from exo_sim.control.walk_response import WalkResponse
from exo_sim.control.yielding import Yielding

#: Lag of a cylinder's force behind its demand, as the regulator has it [s].
LAG = 0.010
#: What a newton metre of feedback counts beside one in the wearer's joints.
EFFORT = 0.15
#: Share of the regulator's gains that is used: straps may be stiffer than they were thought. Of 0, 0.1, 0.15, 0.3 and 0.6 with rows of
#: docs/walking.md in sight: without it straps half as stiff cost 1599 W, with 0.6 straps twice as stiff cost 69 W more than with 0.1.
SHARE = 0.15
#: Forces are read through a low pass of this corner [rad/s].
CORNER = 2.0 * np.pi * 25.0
#: Strides until the regulator's gains no longer change.
_STRIDES = 3


def gains(it: Yielding, along: WalkResponse, period: float) -> NDArray[np.float64]:
    """Return torques for each unit of stretch [N m/m], of its rate [N m s/m] and of lagged torque, shape (PHASES, m, 2 s + m).

    Args:
        it: How straps stretch, and what their forces load the wearer with.
        along: How the machine answers along the calibration's stride.
        period: Of that stride [s].
    """
    m, s = len(it.driven), len(it.strap_stiffness)
    nx, n = 18 + m, len(along.phase)
    lag = -np.expm1(-period / n / LAG)
    box = np.floor(along.phase * PHASES + 0.5).astype(int) % PHASES
    a, b = np.zeros((n, nx, nx)), np.zeros((nx, m))
    a[:, :18, :18], a[:, :18, 18:], a[:, 18:, 18:] = along.by_state, along.by_torque, (1.0 - lag) * np.eye(m)
    b[18:] = lag * np.eye(m)
    effort = EFFORT**2 * np.eye(m)
    value = np.zeros((nx, nx))
    out = np.zeros((PHASES, m, 2 * s + m))
    for _ in range(_STRIDES):
        for k in reversed(range(n)):
            gain = np.linalg.solve(effort + b.T @ value @ b, b.T @ value @ a[k])
            value = a[k].T @ value @ (a[k] - b @ gain)
            felt = it.load[box[k]] @ along.straps[k]
            value[:18, :18] += felt.T @ felt
            value = 0.5 * (value + value.T)
            at = box[k]
            if k == 0 or box[k - 1] != at:  # the first step of a phase's share
                weighted = it.strap[at].T * it.strap_stiffness
                beside = -np.linalg.solve(weighted @ it.strap[at] + 1e-3 * np.eye(9), weighted)  # where the machine is, of stretches
                out[at] = np.concatenate([gain[:, :9] @ beside, gain[:, 9:18] @ beside, gain[:, 18:]], axis=1)
    return out


class StrapFeedback:
    """The regulator at work.

    Args:
        it: How straps stretch, and what they load the wearer with.
        along: How the machine answers along the calibration's stride.
        period: Of that stride [s].
        forces: Strap forces that belong to each phase [N], shape (PHASES, 2 straps).
        share: Of the regulator's gains.
    """

    def __init__(
        self, it: Yielding, along: WalkResponse, period: float, forces: NDArray[np.float64], share: float = SHARE
    ) -> None:
        table = gains(it, along, period)
        table[:, :, : 2 * forces.shape[1]] *= share
        self._gains = np.concatenate([table, table[:1]])
        self._forces = np.concatenate([forces, forces[:1]])
        self._stiffness, self._damping = it.strap_stiffness, it.strap_damping
        self.start()

    def start(self) -> None:
        """Begin with straps that show what belongs to the phase."""
        self._seen = np.zeros(len(self._stiffness))
        self._stretch = np.zeros(len(self._stiffness))
        self._lagged = np.zeros(self._gains.shape[1])

    def step(self, phase: float, forces: NDArray[np.float64], dt: float) -> NDArray[np.float64]:
        """Return the torques of the driven joints [N m] for strap forces on the machine [N], shape (2 straps,)."""
        at = (phase % 1.0) * PHASES
        i = min(int(at), PHASES - 1)
        u = at - i
        off = forces - (1.0 - u) * self._forces[i] - u * self._forces[i + 1]
        self._seen += -np.expm1(-CORNER * dt) * (off - self._seen)
        rate = (self._seen - self._stiffness * self._stretch) / self._damping
        self._stretch += -np.expm1(-dt * self._stiffness / self._damping) * (self._seen / self._stiffness - self._stretch)
        gain = (1.0 - u) * self._gains[i] + u * self._gains[i + 1]
        out = -gain @ np.concatenate([self._stretch, rate, self._lagged])
        self._lagged += -np.expm1(-dt / LAG) * (out - self._lagged)
        return np.asarray(out)
