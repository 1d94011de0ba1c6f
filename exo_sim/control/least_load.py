"""The joint torques for which the straps load the wearer's joints least, over a whole cycle at once.

The machine gives way against straps and ground by d, small and periodic:

    M d'' + C d' + K d = S torque - required - (ground reached by the reference motion itself)

with C and K from straps and from the foot tips that are on the ground, and `required` the inverse dynamics of the
reference. Phases are coupled through the derivatives, which are spectral, so that resonance of payload and harness is
seen. Strap forces, and with them the wearer's extra moments, are linear in d, so the best torque harmonics are a linear
least-squares problem.

Contact is not linear, and gas lags. So the solution is then improved by rehearsal, stride by stride, as iterative learning
control does: what the straps really did over a cycle takes the place of the prediction, and the same least-squares gain
gives the correction (norm-optimal learning, Amann, Owens and Rogers 1996).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.machine_dynamics import PICK, MachineDynamics
from exo_sim.control.strap_loads import force_sums, own_moments, wearer_moments_of
from exo_sim.gait.motion import SAMPLES, Motion
from exo_sim.machine.person import Person
from exo_sim.machine.straps import StrapSet
from exo_sim.rig.schema import Ankle

#: Harmonics of the torques in a stride or repetition.
HARMONICS = 10
_ANKLES = (5, 8)
#: A foot's tip on the ground: spring upward [N/m], dampers along and up [N s/m] (friction creeps, it has no spring).
_GROUND_SPRING = 2e5
_GROUND_DAMPER = np.array([2e4, 1e3])
_LIFTINGS = 4
#: Share of a full correction that a rehearsal makes; halved where it made it worse, going on from the best so far.
_SHARE = 0.5


@dataclass(frozen=True)
class Weights:
    """What counts as load.

    Attributes:
        hip, knee, ankle: Weight of a newton metre in the wearer's joint.
        own: Share of the moments of the wearer's own body that count with those of the straps: 0 asks for a machine that is not felt,
            1 for one that makes the wearer's whole moments small.
        moving: By how much more a moment counts while its joint turns, where it costs work [s/rad].
        torso: Of a newton on the torso straps, up or down [m].
        torso_ahead: Of a newton on the torso straps, forward or back [m].
        push: Of a newton that all straps together push the machine ahead [m]: the wearer holds it against the ground, about a metre below.
        effort: Of a newton metre demanded, steady.
        smoothness: Of a newton metre demanded, for each harmonic.
    """

    hip: float = 1.0
    knee: float = 1.0
    ankle: float = 0.7
    own: float = 0.7
    moving: float = 0.5
    torso: float = 0.5
    torso_ahead: float = 0.1
    push: float = 1.0
    effort: float = 0.05
    smoothness: float = 0.05

    def of_loads(self, rate: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what each load counts at each phase, shape (n, 9): hip, knee, ankle on both sides, torso straps ahead and up, push.

        Args:
            rate: Of the joints [rad/s], shape (n, 6).
        """
        joints = np.array([self.hip, self.knee, self.ankle] * 2) * np.hypot(1.0, self.moving * rate)
        others = np.array([self.torso_ahead, self.torso, self.push])
        return np.concatenate([joints, np.broadcast_to(others, (len(rate), 3))], axis=1)


#: Where both pressures of the cylinders are planned, gas goes with what the torques change by: smoother ones draw a quarter less, and the
#: wearer hardly feels it (docs/sizing.md).
SPARING = Weights(smoothness=0.15)


@dataclass(frozen=True)
class Yielding:
    """How the machine gives way about its reference: inertia d'' + damping d' + stiffness d = torques, n phases.

    Attributes:
        inertia, damping, stiffness: Of straps and ground together, shape (n, 9, 9).
        strap: How straps stretch, across and along, shape (n, 2 straps, 9).
        strap_stiffness, strap_damping: [N/m], [N s/m], shape (2 straps,).
        load: Weighted loads on the wearer for a unit force of each strap on the machine, shape (n, 9, 2 straps).
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


class LeastLoad:
    """Torque harmonics, how they act on the wearer, and how to better them.

    Args:
        dynamics: Of the machine along the motion.
        motion: The reference.
        person: Who wears it.
        straps: Between them.
        ankle: What the ankle can do.
        reach: Least and largest torque that the actuators can hold [N m], shape (n, 6, 2), n phases of
            `machine_dynamics.PICK`.
        weights: What counts as load.
    """

    def __init__(
        self,
        dynamics: MachineDynamics,
        motion: Motion,
        person: Person,
        straps: StrapSet,
        ankle: Ankle,
        reach: NDArray[np.float64],
        weights: Weights | None = None,
    ):
        self.weights = weights or Weights()
        self._driven = [0, 1, 3, 4] if ankle.mode != "powered" else [0, 1, 2, 3, 4, 5]
        self._support = motion.support
        rate = motion.slope[PICK, 3:] / motion.period
        self._matters = np.maximum(motion.support[PICK], 1e-3)[:, None] * self.weights.of_loads(rate)
        self._own = np.concatenate([self.weights.own * own_moments(motion, person), np.zeros((len(rate), 3))], axis=1)
        self._strides = max(1, len(motion.position) // SAMPLES)
        self._phases, self._harmonics = len(rate), HARMONICS * self._strides
        harmonic = np.concatenate([[0], np.repeat(np.arange(1, self._harmonics + 1), 2)]) / self._strides
        effort = np.tile(np.hypot(self.weights.effort, self.weights.smoothness * harmonic), len(self._driven))
        self._effort: NDArray[np.float64] = effort * float(np.sqrt(self._phases))
        self._reach = reach
        self._coefficients = np.zeros(len(self._driven) * (2 * self._harmonics + 1))
        self._solve(dynamics, motion, person, straps, ankle)
        self._coefficients = self._within_reach(self._coefficients)
        self._gain = np.linalg.inv(self._effect.T @ self._effect + np.diag(self._effort**2))
        self._best: tuple[float, NDArray[np.float64]] = (np.inf, self._coefficients)
        self._heard: NDArray[np.float64] | None = None
        self._share = _SHARE

    @property
    def best(self) -> NDArray[np.float64]:
        """Harmonics of the best rehearsal so far, or those of the plan where there was none."""
        return self._best[1] if np.isfinite(self._best[0]) else self._coefficients

    def torque(self, best: bool = False) -> NDArray[np.float64]:
        """Return hip, knee, ankle of the left, then of the right leg along the cycle [N m], shape (samples of the motion, 6).

        Args:
            best: Those of the best rehearsal so far, else those to try next.
        """
        return self.table(self.best if best else self._coefficients)

    def table(self, coefficients: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the torques that harmonics make, as `torque`."""
        out = np.zeros((len(self._support), 6))
        out[:, self._driven] = _basis(len(out), self._harmonics) @ coefficients.reshape(len(self._driven), -1).T
        return out * self._support[:, None]

    def restored(self, change: NDArray[np.float64], forces: NDArray[np.float64], share: float) -> NDArray[np.float64]:
        """Return a change of the best harmonics that takes the straps back to the forces that belong to them.

        Args:
            change: What it was so far.
            forces: By how much the straps' forces on the machine, across and along, were others [N], shape (n, 2 straps).
            share: Of the full correction, 0 to 1.
        """
        load = (np.einsum("nij,nj->ni", self._strap_map, forces) * self._matters).reshape(-1)
        change = change - share * (self._gain @ (self._effect.T @ load + self._effort**2 * change))
        return self._within_reach(self.best + change) - self.best

    def learn(self, moments: NDArray[np.float64], straps: NDArray[np.float64]) -> float:
        """Better the torques by what they did in a rehearsal.

        Args:
            moments: The wearer's extra moments at the n even phases of a cycle [N m], shape (n, 6).
            straps: Force of all torso straps, ahead and up, and of all straps ahead, at the same phases [N], shape (n, 3).

        Returns:
            The cost that was reached; `torque(best=True)` belongs to the least of all.
        """
        load = ((np.concatenate([moments, straps], axis=1) + self._own) * self._matters).reshape(-1)
        tried = self._coefficients
        cost = float(load @ load + (self._effort * tried) @ (self._effort * tried))
        if cost < self._best[0]:
            self._best, self._heard = (cost, tried), load
        else:
            self._share *= 0.5
        best = self._best[1]
        step = self._gain @ (self._effect.T @ self._heard + self._effort**2 * best)
        self._coefficients = self._within_reach(best - self._share * step)
        return cost

    def _within_reach(self, coefficients: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the harmonics that come closest to the torques cut off at what the actuators can hold."""
        basis = _basis(self._phases, self._harmonics)
        table = basis @ coefficients.reshape(len(self._driven), -1).T
        cut = np.clip(table, self._reach[:, self._driven, 0], self._reach[:, self._driven, 1])
        return np.asarray(np.linalg.lstsq(basis, cut, rcond=None)[0].T.reshape(-1), dtype=np.float64)

    def _solve(self, dynamics: MachineDynamics, motion: Motion, person: Person, straps: StrapSet, ankle: Ankle) -> None:
        """Find the effect of each torque harmonic on the loads, and the harmonics that make the loads least."""
        n = self._phases
        first, second = _derivative_matrices(motion.period, n)
        strap = dynamics.strap.reshape(n, -1, 9)
        stiffness, damping = straps.stiffness.reshape(-1), straps.damping.reshape(-1)
        spring = np.einsum("nij,i,nik->njk", strap, stiffness, strap)
        damper = np.einsum("nij,i,nik->njk", strap, damping, strap)
        if ankle.mode == "sprung":
            for joint in _ANKLES:
                spring[:, joint, joint] += ankle.stiffness
        self._strap_map = np.concatenate([wearer_moments_of(dynamics, motion, person, straps), force_sums(dynamics, straps)], axis=1)
        loads = self._strap_map * self._matters[:, :, None]
        inputs = np.zeros((n, 9, len(self._driven), 2 * self._harmonics + 1))
        for i, joint in enumerate(self._driven):
            inputs[:, 3 + joint, i] = _basis(n, self._harmonics) * self._support[PICK, None]
        columns = inputs.reshape(n * 9, -1)
        contact, up = dynamics.contact, dynamics.contact[:, :, 1]
        down = motion.contact[PICK].copy()
        for _ in range(_LIFTINGS):
            k = spring + np.einsum("ncj,nc,nck->njk", up, _GROUND_SPRING * down, up)
            grip = _GROUND_DAMPER * down[:, :, None]
            c = damper + np.einsum("ncaj,nca,ncak->njk", contact, grip, contact)
            reached = np.einsum("ncj,nc->nj", up, _GROUND_SPRING * down * dynamics.tip[:, :, 1])
            reached += np.einsum("ncaj,nca->nj", contact, grip * dynamics.tip_velocity)
            fixed = -(dynamics.required + reached).reshape(-1, 1)
            system = _coupled(dynamics.inertia, c, k, first, second)
            give = np.linalg.solve(system, np.concatenate([columns, fixed], axis=1)).reshape(n, 9, -1)
            rate = np.tensordot(first, give, axes=1)
            force = -(stiffness[:, None] * (strap @ give) + damping[:, None] * (strap @ rate))
            load = (loads @ force).reshape(-1, give.shape[2])
            self._effect, offset = load[:, :-1], load[:, -1] + (self._own * self._matters).reshape(-1)
            normal = self._effect.T @ self._effect + np.diag(self._effort**2)
            self._coefficients = np.linalg.solve(normal, -self._effect.T @ offset)
            all_of_it = np.append(self._coefficients, 1.0)
            height = np.einsum("ncj,nj->nc", up, give @ all_of_it) + dynamics.tip[:, :, 1]
            rising = np.einsum("ncj,nj->nc", up, rate @ all_of_it) + dynamics.tip_velocity[:, :, 1]
            pulling = down & (_GROUND_SPRING * height + _GROUND_DAMPER[1] * rising > 0)
            if not pulling.any():
                break
            down &= ~pulling
        self.yielding = Yielding(dynamics.inertia, c, k, strap, stiffness, damping, loads, tuple(self._driven))


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


def _basis(count: int, harmonics: int) -> NDArray[np.float64]:
    """Return constant, cosines and sines of the harmonics at evenly spaced phases, shape (count, 2 harmonics + 1)."""
    phase = np.arange(count) / count
    columns = [np.ones(count)]
    for h in range(1, harmonics + 1):
        columns += [np.cos(2 * np.pi * h * phase), np.sin(2 * np.pi * h * phase)]
    return np.stack(columns, axis=1)
