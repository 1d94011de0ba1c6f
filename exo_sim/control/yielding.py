"""How the machine gives way to joint torques: linear about its reference motion, between straps and the foot tips that are on the ground.

    M d'' + C d' + K d = S torque - required - (ground reached by the reference motion itself)

with C and K from straps and from the foot tips that carry. Phases are coupled through the derivatives, which are spectral, so that
resonance of payload and harness is seen.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.machine_dynamics import MachineDynamics
from exo_sim.machine.straps import StrapSet
from exo_sim.rig.schema import Ankle

_ANKLES = (5, 8)
#: A foot's tip on the ground: spring upward [N/m], dampers along and up [N s/m] (friction creeps, it has no spring).
_GROUND_SPRING = 2e5
_GROUND_DAMPER = np.array([2e4, 1e3])


@dataclass(frozen=True)
class Yielding:
    """How the machine gives way about its reference: inertia d'' + damping d' + stiffness d = torques, n phases.

    Attributes:
        inertia, damping, stiffness: Of straps and ground together, shape (n, 9, 9).
        strap: How straps stretch, across and along, shape (n, 2 straps, 9).
        strap_stiffness, strap_damping: [N/m], [N s/m], shape (2 straps,).
        load: Weighted loads on the wearer for a unit force of each strap on the machine, shape (n, 10, 2 straps).
        driven: Which of the six joints have a torque.
    """

    inertia: NDArray[np.float64]
    damping: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    strap: NDArray[np.float64]
    strap_stiffness: NDArray[np.float64]
    strap_damping: NDArray[np.float64]
    load: NDArray[np.float64]
    driven: tuple[int, ...]


class StrapResponse:
    """Strap forces that follow from torques, for foot tips that carry.

    Args:
        dynamics: Of the machine along its motion, n phases.
        period: Of a cycle [s].
        straps: Between machine and wearer.
        ankle: What the ankle can do.
        inputs: Torques of the six joints that are asked about, shape (n, 6, columns).
    """

    def __init__(self, dynamics: MachineDynamics, period: float, straps: StrapSet, ankle: Ankle, inputs: NDArray[np.float64]):
        n = len(dynamics.inertia)
        self._dynamics = dynamics
        self._first, self._second = _derivative_matrices(period, n)
        self.strap = dynamics.strap.reshape(n, -1, 9)
        self.stiffness, self.damping = straps.stiffness.reshape(-1), straps.damping.reshape(-1)
        self._spring = np.einsum("nij,i,nik->njk", self.strap, self.stiffness, self.strap)
        self._damper = np.einsum("nij,i,nik->njk", self.strap, self.damping, self.strap)
        if ankle.mode == "sprung":
            for joint in _ANKLES:
                self._spring[:, joint, joint] += ankle.stiffness
        self._columns = np.concatenate([np.zeros((n, 3, inputs.shape[2])), inputs], axis=1).reshape(n * 9, -1)

    def forces(self, down: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return strap forces, and how far the machine gives way.

        Args:
            down: For what share of each phase each of `machine_dynamics.CONTACTS` carries, shape (n, 4).

        Returns:
            Forces on the machine, across and along, shape (n, 2 straps, columns + 1): for a unit of each column of the inputs, and, the
            last, without torques; and the coordinates by which it gives way, shape (n, 9, columns + 1).
        """
        it, up = self._dynamics, self._dynamics.contact[:, :, 1]
        damping, stiffness = self.held(down)
        grip = _GROUND_DAMPER * down[:, :, None]
        reached = np.einsum("ncj,nc->nj", up, _GROUND_SPRING * down * it.tip[:, :, 1])
        reached += np.einsum("ncaj,nca->nj", it.contact, grip * it.tip_velocity)
        fixed = -(it.required + reached).reshape(-1, 1)
        system = _coupled(it.inertia, damping, stiffness, self._first, self._second)
        give = np.linalg.solve(system, np.concatenate([self._columns, fixed], axis=1)).reshape(len(down), 9, -1)
        rate = np.tensordot(self._first, give, axes=1)
        force = -(self.stiffness[:, None] * (self.strap @ give) + self.damping[:, None] * (self.strap @ rate))
        return force, give

    def held(self, down: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return damping and stiffness of straps and ground together, shape (n, 9, 9) each."""
        contact, up = self._dynamics.contact, self._dynamics.contact[:, :, 1]
        stiffness = self._spring + np.einsum("ncj,nc,nck->njk", up, _GROUND_SPRING * down, up)
        damping = self._damper + np.einsum("ncaj,nca,ncak->njk", contact, _GROUND_DAMPER * down[:, :, None], contact)
        return damping, stiffness

    def pulled(self, give: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which foot tips the ground would have to pull at, shape (n, 4), for a machine that gives way by (n, 9)."""
        it, up = self._dynamics, self._dynamics.contact[:, :, 1]
        height = np.einsum("ncj,nj->nc", up, give) + it.tip[:, :, 1]
        rising = np.einsum("ncj,nj->nc", up, self._first @ give) + it.tip_velocity[:, :, 1]
        return np.asarray(_GROUND_SPRING * height + _GROUND_DAMPER[1] * rising > 0)


def _derivative_matrices(period: float, n: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the spectral first and second derivative by time on n even phases, shape (n, n)."""
    rate = 2j * np.pi * np.fft.fftfreq(n, 1 / n)
    second = np.fft.ifft(rate[:, None] ** 2 * np.fft.fft(np.eye(n), axis=0), axis=0).real
    rate[n // 2] = 0.0
    first = np.fft.ifft(rate[:, None] * np.fft.fft(np.eye(n), axis=0), axis=0).real
    return first / period, second / period**2


def _coupled(
    m: NDArray[np.float64],
    c: NDArray[np.float64],
    k: NDArray[np.float64],
    first: NDArray[np.float64],
    second: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return M d'' + C d' + K d as one matrix over all n phases, shape (9 n, 9 n)."""
    system = np.einsum("nij,nm->nimj", m, second) + np.einsum("nij,nm->nimj", c, first)
    phase = np.arange(len(m))
    system[phase, :, phase, :] += k
    return system.reshape(9 * len(m), 9 * len(m))
