"""Joint torques that carry frame and payload through the stance leg: four laws. The first three are tables over the phase of the motion.

- `virtual_support`: the stance leg pushes on the ground with a force that carries the whole machine, aimed at its mass
  centre.
- `inverse_dynamics`: the torques that the motion needs, with the centre of pressure inside the foot and the horizontal
  ground force chosen so that the torso straps give no moment.
- `least_load` (`least_load.py`): the torques for which the straps, as the springs they are, load the wearer's joints
  least, improved by rehearsing a few strides.
- `causal` (`causal.py`): the same as calibrated on the mean stride, read at a phase that is estimated, and changed by strap forces.

A table depends on rig, payload, wearer and cadence and is computed before the run; the controller only interpolates.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.machine_dynamics import PICK, MachineDynamics
from exo_sim.errors import ScenarioError, nearest
from exo_sim.gait.motion import SAMPLES, Motion
from exo_sim.machine.straps import StrapSet
from exo_sim.rig.schema import Ankle

LAWS = ("virtual_support", "inverse_dynamics", "least_load", "causal")
DEFAULT_LAW = "least_load"
#: Coordinates of the joint torques: hip, knee, ankle of the left, then of the right leg.
JOINTS = slice(3, 9)
#: Harmonics kept of a table: what lies above, the gas could not follow.
_HARMONICS = 12


def demand(law: str, dynamics: MachineDynamics, motion: Motion, straps: StrapSet, ankle: Ankle) -> NDArray[np.float64]:
    """Return the joint torques to ask for along one cycle, by one of the laws that need no rehearsal.

    Args:
        law: "virtual_support" or "inverse_dynamics".
        dynamics: Of the machine along `motion`.
        motion: The reference.
        straps: Between machine and wearer.
        ankle: What the ankle can do.

    Returns:
        hip, knee, ankle of the left, then of the right leg [N m], shape (samples of the motion, 6). Ankle columns are zero
        unless it is powered.

    Raises:
        ScenarioError: another law.
    """
    if law == "virtual_support":
        torque = _virtual_support(dynamics, motion)
    elif law == "inverse_dynamics":
        torque = _inverse_dynamics(dynamics, motion, straps)
    else:
        raise ScenarioError(f'unknown demand law "{law}"{nearest(law, LAWS)}')
    return limit(_fine(torque * motion.support[PICK, None], len(motion.position)), ankle)


def limit(torque: NDArray[np.float64], ankle: Ankle) -> NDArray[np.float64]:
    """Return torques (n, 6) with those of the ankles within what the ankle can give."""
    most = ankle.torque if ankle.mode == "powered" else 0.0
    limited = torque.copy()
    limited[:, [2, 5]] = np.clip(limited[:, [2, 5]], -most, most)
    return limited


def _fine(table: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Keep the lower harmonics of each stride of values at even phases and evaluate them at `count` samples."""
    spectrum = np.fft.rfft(table, axis=0)
    spectrum[_HARMONICS * (count // SAMPLES) + 1 :] = 0.0
    return np.fft.irfft(spectrum, count, axis=0) * (count / len(table))


def _virtual_support(dynamics: MachineDynamics, motion: Motion) -> NDArray[np.float64]:
    """Transposed Jacobian of a ground force through the centre of pressure, aimed at the mass centre."""
    vertical = dynamics.mass * 9.81
    share = motion.share[PICK]
    torque = np.zeros((len(share), 6))
    for foot in range(2):
        aim = dynamics.mass_centre - dynamics.pressure_point[:, foot]
        force = share[:, foot, None] * vertical * np.stack([aim[:, 0] / aim[:, 1], np.ones(len(aim))], axis=1)
        torque -= np.einsum("nk,nkj->nj", force, dynamics.pressure[:, foot])[:, JOINTS]
    return torque


def _inverse_dynamics(dynamics: MachineDynamics, motion: Motion, straps: StrapSet) -> NDArray[np.float64]:
    """Inverse dynamics with zero moment of the torso straps about their middle."""
    need, pressure, share = dynamics.required, dynamics.pressure, motion.share[PICK]
    torso = [i for i, name in enumerate(straps.names) if name.startswith("torso")]
    world = np.einsum("nska,nskj->nsaj", dynamics.strap_direction[:, torso], dynamics.strap[:, torso])
    pull = world[:, :, 0].mean(
        axis=1
    )  # generalised force of a unit horizontal strap force at the middle of the harness
    push = np.einsum("nf,nfkj->nkj", share, pressure)  # of a unit ground force, shared
    vertical = need[:, 1]
    horizontal = (need[:, 2] - vertical * push[:, 1, 2] - need[:, 0] * pull[:, 2]) / (push[:, 0, 2] - pull[:, 2])
    force = np.stack([horizontal, vertical], axis=1)
    return need[:, JOINTS] - np.einsum("nk,nkj->nj", force, push)[:, JOINTS]
