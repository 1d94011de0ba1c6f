"""Joint torques that carry frame and payload through the stance leg: three laws, each a table over the phase of the motion.

- `virtual_support`: the stance leg pushes on the ground with a force that carries the whole machine, aimed at its mass centre.
- `inverse_dynamics`: the torques that the motion needs, with the centre of pressure inside the foot and the horizontal ground
  force chosen so that the torso straps give no moment.
- `least_load`: the torques for which the straps, as the springs they are, load the wearer's joints least.

A table depends on rig, payload, wearer and cadence and is computed before the run; the controller only interpolates.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.machine_dynamics import MachineDynamics
from exo_sim.errors import ScenarioError, nearest
from exo_sim.gait.motion import Motion
from exo_sim.machine.person import Person
from exo_sim.machine.straps import StrapSet
from exo_sim.machine.wearer import extra_moments
from exo_sim.rig.schema import Ankle

LAWS = ("virtual_support", "inverse_dynamics", "least_load")
DEFAULT_LAW = "least_load"
#: Coordinates of the joint torques: hip, knee, ankle of the left, then of the right leg.
JOINTS = slice(3, 9)
_ANKLES = (5, 8)
#: Harmonics kept of a table: what lies above, the gas could not follow.
_HARMONICS = 12

_GROUND_STIFFNESS = np.array([5e4, 2e5])  # of a foot's tip, x and z [N/m]: stiff against every strap


def demand(
    law: str, dynamics: MachineDynamics, motion: Motion, person: Person, straps: StrapSet, ankle: Ankle
) -> NDArray[np.float64]:
    """Return the joint torques to ask for along one cycle.

    Args:
        law: One of `LAWS`.
        dynamics: Of the machine along `motion`.
        motion: The reference.
        person: Who wears it.
        straps: Between them.
        ankle: What the ankle can do.

    Returns:
        hip, knee, ankle of the left, then of the right leg [N m], shape (n, 6). Ankle columns are zero unless it is powered.

    Raises:
        ScenarioError: an unknown law.
    """
    if law == "virtual_support":
        torque = _virtual_support(dynamics, motion)
    elif law == "inverse_dynamics":
        torque = _inverse_dynamics(dynamics, motion, straps)
    elif law == "least_load":
        torque = _least_load(dynamics, motion, person, straps, ankle)
    else:
        raise ScenarioError(f'unknown demand law "{law}"{nearest(law, LAWS)}')
    torque = torque * motion.support[:, None]
    if ankle.mode == "powered":
        torque[:, [2, 5]] = np.clip(torque[:, [2, 5]], -ankle.torque, ankle.torque)
    else:
        torque[:, [2, 5]] = 0.0
    return _smooth(torque)


def _smooth(table: NDArray[np.float64]) -> NDArray[np.float64]:
    """Drop what is above the kept harmonics."""
    spectrum = np.fft.rfft(table, axis=0)
    spectrum[_HARMONICS + 1 :] = 0.0
    return np.fft.irfft(spectrum, len(table), axis=0)


def _virtual_support(dynamics: MachineDynamics, motion: Motion) -> NDArray[np.float64]:
    """Transposed Jacobian of a ground force through the centre of pressure, aimed at the mass centre."""
    vertical = dynamics.mass * 9.81
    torque = np.zeros((len(motion.share), 6))
    for foot in range(2):
        aim = dynamics.mass_centre_point - dynamics.pressure_point[:, foot]
        force = motion.share[:, foot, None] * vertical * np.stack([aim[:, 0] / aim[:, 1], np.ones(len(aim))], axis=1)
        torque -= np.einsum("nk,nkj->nj", force, dynamics.pressure[:, foot])[:, JOINTS]
    return torque


def _inverse_dynamics(dynamics: MachineDynamics, motion: Motion, straps: StrapSet) -> NDArray[np.float64]:
    """Inverse dynamics with zero moment of the torso straps about their middle."""
    need, pressure, share = dynamics.required, dynamics.pressure, motion.share
    torso = [i for i, name in enumerate(straps.names) if name.startswith("torso")]
    world = np.einsum("nska,nskj->nsaj", dynamics.strap_direction[:, torso], dynamics.strap[:, torso])
    pull = world[:, :, 0].mean(axis=1)  # generalised force of a unit horizontal strap force at the middle of the harness
    push = np.einsum("nf,nfkj->nkj", share, pressure)  # of a unit ground force, shared
    vertical = need[:, 1]
    horizontal = (need[:, 2] - vertical * push[:, 1, 2] - need[:, 0] * pull[:, 2]) / (push[:, 0, 2] - pull[:, 2])
    force = np.stack([horizontal, vertical], axis=1)
    return need[:, JOINTS] - np.einsum("nk,nkj->nj", force, push)[:, JOINTS]


def _least_load(
    dynamics: MachineDynamics, motion: Motion, person: Person, straps: StrapSet, ankle: Ankle
) -> NDArray[np.float64]:
    """Minimise the wearer's extra moments over the joint torques.

    The machine gives way against straps and ground by d, small: K d = S torque - required, with K from all straps and from the foot
    tips on the ground. Strap forces, and with them the wearer's extra moments, are linear in d and so in the torques. Tips that
    would pull on the ground are lifted and the phase solved again.
    """
    n, n_straps = dynamics.strap.shape[:2]
    flat = dynamics.strap.reshape(n, 2 * n_straps, 9)
    stiffness = straps.stiffness.reshape(-1)
    spring = np.einsum("nij,i,nik->njk", flat, stiffness, flat)
    if ankle.mode == "sprung":
        for joint in _ANKLES:
            spring[:, joint, joint] += ankle.stiffness
    load = _wearer_map(dynamics, motion, person, straps)  # (n, 6, 2 straps): moments from forces on the machine
    from_give = -np.einsum("nei,i,nij->nej", load, stiffness, flat)
    vertical = np.zeros((n, 1, 9))
    for i, name in enumerate(straps.names):
        if name.startswith("torso"):
            world = np.einsum("nka,nkj->naj", dynamics.strap_direction[:, i], dynamics.strap[:, i])
            vertical[:, 0] -= stiffness[2 * i + 1] * world[:, 1]
    from_give = np.concatenate([from_give * _WEIGHT[None, :, None], _TORSO_WEIGHT * vertical], axis=1)

    driven = [0, 1, 3, 4] if ankle.mode != "powered" else [0, 1, 2, 3, 4, 5]
    select = np.eye(9)[:, [3 + j for j in driven]]
    down = motion.contact.copy()
    torque = np.zeros((n, len(driven)))
    for _ in range(4):
        ground = _GROUND_STIFFNESS * down[:, :, None]
        total = spring + np.einsum("ncaj,nca,ncak->njk", dynamics.contact, ground, dynamics.contact)
        give_by_torque = np.linalg.solve(total, np.broadcast_to(select, (n, *select.shape)))
        give_fixed = np.linalg.solve(total, dynamics.required[:, :, None])
        effect, offset = from_give @ give_by_torque, from_give @ give_fixed
        normal = effect.transpose(0, 2, 1) @ effect + _EFFORT * np.eye(len(driven))
        torque = np.linalg.solve(normal, effect.transpose(0, 2, 1) @ offset)[:, :, 0]
        give = (give_by_torque @ torque[:, :, None] - give_fixed)[:, :, 0]
        lift = np.einsum("ncj,nj->nc", dynamics.contact[:, :, 1], give)
        pulling = down & (lift > 0)
        if not pulling.any():
            break
        down = down & ~pulling
    full = np.zeros((n, 6))
    full[:, driven] = torque
    return full


_WEIGHT = np.array([1.0, 1.0, 0.5, 1.0, 1.0, 0.5])  # ankles count half: they are the strongest
_TORSO_WEIGHT = 0.1  # m: a newton on the shoulders against a newton metre in a joint
_EFFORT = 1e-3


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
