"""Interface-force feedback: joint torques at once against strap forces that do not belong to the phase.

From each strap's force follow its stretch and the rate of it, the strap being a spring beside a damper, and from all stretches where the
machine is beside its wearer. What to do about it is the periodic linear-quadratic regulator of the machine on straps and ground
(Bittanti, Colaneri and De Nicolao 1991, in "The Riccati Equation", Springer, chapter 6), its cost the loads on the wearer's joints, a lag
of the cylinders' force among its states.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.machine_dynamics import PHASES
from exo_sim.control.yielding import Yielding

#: Lag of a cylinder's force behind its demand, as the regulator has it [s].
LAG = 0.010
#: What a newton metre of feedback counts beside one in the wearer's joints.
EFFORT = 0.15
#: Share of the regulator's gains that is used: straps may be stiffer than they were thought.
SHARE = 0.3
#: Forces are read through a low pass of this corner [rad/s].
CORNER = 2.0 * np.pi * 25.0
#: Steps of the regulator between two phases, and strides until its gains no longer change.
_STEPS, _STRIDES = 4, 3


def gains(it: Yielding, period: float) -> NDArray[np.float64]:
    """Return torques for each unit of stretch [N m/m], of its rate [N m s/m] and of lagged torque, shape (PHASES, m, 2 s + m)."""
    from scipy.linalg import expm  # machines without this feedback do not ask for it

    m, s = len(it.driven), len(it.strap_stiffness)
    nx, dt = 18 + m, period / PHASES / _STEPS
    into = np.zeros((9, m))
    into[[3 + joint for joint in it.driven], range(m)] = 1.0
    steps, costs = [], []
    for n in range(PHASES):
        rate = np.zeros((nx + m, nx + m))
        rate[:9, 9:18] = np.eye(9)
        rate[9:18, : nx] = np.linalg.solve(it.inertia[n], np.concatenate([-it.stiffness[n], -it.damping[n], into], axis=1))
        rate[18:nx, 18:nx], rate[18:nx, nx:] = -np.eye(m) / LAG, np.eye(m) / LAG
        moved = expm(rate * dt)
        steps.append((moved[:nx, :nx], moved[:nx, nx:]))
        felt = np.zeros((it.load.shape[1], nx))
        felt[:, :9] = it.load[n] @ (it.strap_stiffness[:, None] * it.strap[n])
        felt[:, 9:18] = it.load[n] @ (it.strap_damping[:, None] * it.strap[n])
        costs.append(felt.T @ felt + 1e-6 * np.eye(nx))
    effort = EFFORT**2 * np.eye(m)
    value = costs[-1]
    out = np.zeros((PHASES, m, 2 * s + m))
    for _ in range(_STRIDES):
        for n in reversed(range(PHASES)):
            (a, b), cost = steps[n], costs[n]
            for _ in range(_STEPS):
                gain = np.linalg.solve(effort + b.T @ value @ b, b.T @ value @ a)
                value = cost + a.T @ value @ (a - b @ gain)
                value = 0.5 * (value + value.T)
            weighted = it.strap[n].T * it.strap_stiffness
            beside = -np.linalg.solve(weighted @ it.strap[n] + 1e-3 * np.eye(9), weighted)  # where the machine is, of stretches
            out[n] = np.concatenate([gain[:, :9] @ beside, gain[:, 9:18] @ beside, gain[:, 18:]], axis=1)
    return out


class StrapFeedback:
    """The regulator at work.

    Args:
        it: How the machine gives way.
        period: Of the calibration's strides [s].
        forces: Strap forces that belong to each phase [N], shape (PHASES, 2 straps).
        share: Of the regulator's gains.
    """

    def __init__(self, it: Yielding, period: float, forces: NDArray[np.float64], share: float = SHARE) -> None:
        table = gains(it, period)
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
