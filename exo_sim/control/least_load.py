"""The joint torques for which the straps load the wearer's joints least, over a whole cycle at once.

The machine gives way against straps and ground by d, small and periodic:

    M d'' + C d' + K d = S torque - required - (ground reached by the reference motion itself)

with C and K from straps and from the foot tips that are on the ground, and `required` the inverse dynamics of the reference.
Phases are coupled through the derivatives, which are spectral; so the torques may use the compliance but not fool it. Strap forces,
and with them the wearer's extra moments, are linear in d, so the best torque harmonics are a linear least-squares problem. Tips that
would pull on the ground are lifted and the cycle is solved again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.machine_dynamics import MachineDynamics
from exo_sim.gait.motion import SAMPLES, Motion
from exo_sim.machine.person import Person
from exo_sim.machine.straps import StrapSet
from exo_sim.machine.wearer import extra_moments
from exo_sim.rig.schema import Ankle

#: Phases at which the cycle is solved, and harmonics of the torques.
PHASES = 64
HARMONICS = 10
_ANKLES = (5, 8)
#: A foot's tip on the ground: spring upward [N/m], dampers along and up [N s/m] (friction creeps, it has no spring).
_GROUND_SPRING = 2e5
_GROUND_DAMPER = np.array([2e4, 1e3])


@dataclass(frozen=True)
class Weights:
    """What counts as load.

    Attributes:
        hip, knee, ankle: Weight of a newton metre in the wearer's joint.
        torso: Of a newton on the torso straps, up or down [m].
        effort: Of a newton metre demanded.
        smoothness: Of a newton metre demanded, for each harmonic.
    """

    hip: float = 1.0
    knee: float = 1.0
    ankle: float = 0.7
    torso: float = 0.5
    effort: float = 0.05
    smoothness: float = 0.05


def least_load(
    dynamics: MachineDynamics,
    motion: Motion,
    person: Person,
    straps: StrapSet,
    ankle: Ankle,
    weights: Weights | None = None,
) -> NDArray[np.float64]:
    """Return the torques of hip, knee, ankle of the left, then of the right leg along the cycle [N m], shape (SAMPLES, 6)."""
    weights = weights or Weights()
    pick = slice(0, SAMPLES, SAMPLES // PHASES)
    first, second = _derivative_matrices(motion.period)
    strap = dynamics.strap[pick].reshape(PHASES, -1, 9)
    stiffness, damping = straps.stiffness.reshape(-1), straps.damping.reshape(-1)
    spring = np.einsum("nij,i,nik->njk", strap, stiffness, strap)
    damper = np.einsum("nij,i,nik->njk", strap, damping, strap)
    if ankle.mode == "sprung":
        for joint in _ANKLES:
            spring[:, joint, joint] += ankle.stiffness
    contact, tip, drift = dynamics.contact[pick], dynamics.tip[pick], dynamics.tip_velocity[pick]
    driven = [0, 1, 3, 4] if ankle.mode != "powered" else [0, 1, 2, 3, 4, 5]
    basis = _torque_basis()
    loads = _wearer_map(dynamics, motion, person, straps)[pick]
    loads = loads * np.array([weights.hip, weights.knee, weights.ankle] * 2)[None, :, None]
    loads = np.concatenate([loads, weights.torso * _torso_up(dynamics, straps)[pick]], axis=1)

    inputs = np.zeros((PHASES, 9, len(driven), basis.shape[1]))
    for i, joint in enumerate(driven):
        inputs[:, 3 + joint, i] = basis
    inputs = inputs.reshape(PHASES * 9, -1)
    harmonic = np.concatenate([[0], np.repeat(np.arange(1, HARMONICS + 1), 2)])
    effort = np.tile(np.hypot(weights.effort, weights.smoothness * harmonic), len(driven)) * np.sqrt(PHASES)

    down = motion.contact[pick].copy()
    coefficients = np.zeros(inputs.shape[1])
    for _ in range(6):
        k = spring + np.einsum("ncj,nc,nck->njk", contact[:, :, 1], _GROUND_SPRING * down, contact[:, :, 1])
        grip = _GROUND_DAMPER * down[:, :, None]
        c = damper + np.einsum("ncaj,nca,ncak->njk", contact, grip, contact)
        system = _coupled(dynamics.inertia[pick], c, k, first, second)
        reached = np.einsum("ncj,nc->nj", contact[:, :, 1], _GROUND_SPRING * down * tip[:, :, 1])
        reached += np.einsum("ncaj,nca->nj", contact, grip * drift)
        fixed = -(dynamics.required[pick] + reached).reshape(-1, 1)
        give = np.linalg.solve(system, np.concatenate([inputs, fixed], axis=1)).reshape(PHASES, 9, -1)
        rate = np.tensordot(first, give, axes=1)
        force = -(stiffness[:, None] * (strap @ give) + damping[:, None] * (strap @ rate))
        load = (loads @ force).reshape(-1, give.shape[2])
        effect, offset = load[:, :-1], load[:, -1]
        coefficients = np.linalg.solve(effect.T @ effect + np.diag(effort**2), -effect.T @ offset)
        moved, moving = give[:, :, :-1] @ coefficients + give[:, :, -1], rate[:, :, :-1] @ coefficients + rate[:, :, -1]
        press = -_GROUND_SPRING * (np.einsum("ncj,nj->nc", contact[:, :, 1], moved) + tip[:, :, 1])
        press -= _GROUND_DAMPER[1] * (np.einsum("ncj,nj->nc", contact[:, :, 1], moving) + drift[:, :, 1])
        pulling = down & (press < 0)
        if not pulling.any():
            break
        down = down & ~pulling
    torque = np.zeros((SAMPLES, 6))
    torque[:, driven] = _fine_basis() @ coefficients.reshape(len(driven), -1).T
    return torque


def _derivative_matrices(period: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the spectral first and second derivative by time on the phases, shape (PHASES, PHASES)."""
    rate = 2j * np.pi * np.fft.fftfreq(PHASES, 1 / PHASES)
    second = np.fft.ifft(rate[:, None] ** 2 * np.fft.fft(np.eye(PHASES), axis=0), axis=0).real
    rate[PHASES // 2] = 0.0
    first = np.fft.ifft(rate[:, None] * np.fft.fft(np.eye(PHASES), axis=0), axis=0).real
    return first / period, second / period**2


def _coupled(
    m: NDArray[np.float64],
    c: NDArray[np.float64],
    k: NDArray[np.float64],
    first: NDArray[np.float64],
    second: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return M d'' + C d' + K d as one matrix over all phases, shape (9 PHASES, 9 PHASES)."""
    system = np.einsum("nij,nm->nimj", m, second) + np.einsum("nij,nm->nimj", c, first)
    phase = np.arange(PHASES)
    system[phase, :, phase, :] += k
    return system.reshape(9 * PHASES, 9 * PHASES)


def _basis(count: int) -> NDArray[np.float64]:
    phase = np.arange(count) / count
    columns = [np.ones(count)]
    for h in range(1, HARMONICS + 1):
        columns += [np.cos(2 * np.pi * h * phase), np.sin(2 * np.pi * h * phase)]
    return np.stack(columns, axis=1)


def _torque_basis() -> NDArray[np.float64]:
    return _basis(PHASES)


def _fine_basis() -> NDArray[np.float64]:
    return _basis(SAMPLES)


def _torso_up(dynamics: MachineDynamics, straps: StrapSet) -> NDArray[np.float64]:
    """Return the vertical force on the torso straps for a unit force of each strap, shape (n, 1, 2 straps)."""
    n = len(dynamics.strap)
    out = np.zeros((n, 1, 2 * len(straps.names)))
    for i, name in enumerate(straps.names):
        if name.startswith("torso"):
            out[:, 0, 2 * i : 2 * i + 2] = dynamics.strap_direction[:, i, :, 1]
    return out


def _wearer_map(
    dynamics: MachineDynamics, motion: Motion, person: Person, straps: StrapSet
) -> NDArray[np.float64]:
    """Return the wearer's extra moments for a unit force of each strap on the machine, shape (n, 6, 2 straps)."""
    n, n_straps = dynamics.strap.shape[:2]
    out = np.empty((n, 6, 2 * n_straps))
    for i in range(n_straps):
        segment = straps.segment[i]
        # directions are rows across, along; the anchor in space is across * x + along * z
        direction = dynamics.strap_direction[:, i]
        arm = straps.anchor[i, 0] * direction[:, 0] + straps.anchor[i, 1] * direction[:, 1]
        for k in range(2):
            force = -direction[:, k]
            wrench = np.zeros((n, 7, 3))
            wrench[:, segment, :2] = force
            wrench[:, segment, 2] = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
            out[:, :, 2 * i + k] = extra_moments(
                dynamics.poses, wrench, motion.share, motion.pressure_centre, person.ankle_height
            )
    return out
