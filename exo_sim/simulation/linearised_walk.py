"""How a machine answers to its joint torques along a walk: MuJoCo's own step, linearised where it was taken.

A machine on the ground with a load on its back is an inverted pendulum between straps: what holds it up, the ground's force and the weight,
also tips it over, and half of what straps hold is that. So its answer follows from the walk itself, not from the reference alone: every
step is taken again from where it began, with each coordinate, rate and torque a little otherwise. Steps in a row, the last followed by the
first, give what a steady change of the torques over the cycle does to a steady walk.

When a foot comes down hangs on the state, and so does what it does then. A foot that bounces, or hovers and touches now and then, is
another matter: each such touch would multiply the answer, and what is worked out along some dozens of them has nothing to do with what
torques do.
"""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.control.machine_dynamics import CONTACTS
from exo_sim.control.walk_response import WalkResponse
from exo_sim.deciding_number import Number
from exo_sim.machine.person import COORDINATES
from exo_sim.simulation.linearised_step import Bodies, Scratch, StrapArrays, linearise
from exo_sim.simulation.views import mechanics
from exo_sim.simulation.walk import JOINTS, Walk

Array = NDArray[np.float64]

#: A tip that comes down more slowly than this [m/s] meets the ground as if it came so fast.
_SLOWEST = 0.02
BOUNCES = Number(
    0.03, "s", "a tip that was off the ground for no longer has bounced: contacts settle in 0.01 to 0.02 s, a foot swings for 0.3 s",
    "starting and stopping, 34 kg: 43 of 67 landings of a cycle were bounces; with them the answer grew by a factor of 1e9 within 0.1 s",
)  # fmt: skip
#: What a contact changes the state by in a step, at the least [m, rad, m/s, rad/s].
_TOUCH = 1e-6
_NAMES = ("torso_x", "torso_z", *COORDINATES[2:])


def linearised(walk: Walk, driven: list[int]) -> WalkResponse:
    """Linearise the last whole cycle of a walk of a wearer whose motion is prescribed.

    Args:
        walk: At least a cycle long.
        driven: Which of the six joints have a torque.
    """
    period = walk.motion.period
    n = round(period / walk.step)
    end = round(np.floor(walk.time[-1] / period + 1e-6) * period / walk.step) - walk.first
    rows = slice(end - n, end)
    place, rate = (_columns(walk, [f"{name}.{what}" for name in _NAMES], rows) for what in ("position", "velocity"))
    torque = _columns(walk, [f"{name}.torque" for name in JOINTS], rows)
    model, straps, count, width = walk.model, walk.straps, len(walk.straps.names), 2 * len(_NAMES)
    data = mujoco.MjData(model)
    tips = np.array([model.geom(name).id for name in CONTACTS])
    by_state, by_torque, by_strap = np.empty((n, width, width)), np.empty((n, width, len(driven))), np.empty((n, 2 * count, width))
    by_tip = np.empty((n, len(tips), width))
    scratch = Scratch(
        np.zeros((count, 2)), np.zeros((count, 2)), np.zeros(count), np.zeros((7, 3)), np.zeros(width), np.zeros(width),
        np.zeros(2 * count), np.zeros(2 * count),
    )  # fmt: skip
    linearise(
        mechanics(model, data), Bodies.of(model, data), StrapArrays.of(straps), model.body("torso").id, tips,
        np.ascontiguousarray(walk.poses[rows]), place, rate, torque, np.array([3 + joint for joint in driven]), scratch, by_state,
        by_torque, by_strap, by_tip,
    )  # fmt: skip
    _without_touches(by_state, by_torque, walk.step)
    touched = np.abs(by_tip).max(axis=2) > _TOUCH
    for k, tip in zip(*np.nonzero(landings(touched, walk.step))):
        by_state[k] += np.outer(by_tip[k, tip] / walk.step, _sooner(walk, data, place[k], rate[k], int(tips[tip])))
    return WalkResponse(walk.time[rows] / period, by_state, by_torque, by_strap)


def _without_touches(by_state: Array, by_torque: Array, step: float) -> None:
    """Put the step before in the place of each [s] in which the little change itself made a tip touch or leave.

    No contact does more about a place in a step than to undo it: rates that answer by more than 1/step [1/s] are a force that was there
    with the change and not without.
    """
    for k in np.nonzero(np.linalg.norm(by_state[:, 9:, :9], axis=(1, 2)) > 1.0 / step)[0]:
        by_state[k], by_torque[k] = by_state[k - 1], by_torque[k - 1]


def landings(touched: NDArray[np.bool_], step: float) -> NDArray[np.bool_]:
    """Return where tips that were off the ground for longer than `BOUNCES` come down, shape (n, tips), along a cycle in steps [s]."""
    lately = np.zeros_like(touched)
    for k in range(1, round(BOUNCES / step) + 1):
        lately |= np.roll(touched, k, axis=0)
    return touched & ~lately


def _columns(walk: Walk, names: list[str], rows: slice) -> Array:
    return np.stack([walk.columns[name][rows] for name in names], axis=1)


def _sooner(walk: Walk, data: mujoco.MjData, place: Array, rate: Array, tip: int) -> Array:
    """Return by how much sooner a tip that comes down meets the ground for each coordinate and rate [s], shape (18,)."""
    model, ground = walk.model, walk.motion.ground
    data.qpos[:], data.qvel[:] = place, rate
    mujoco.mj_fwdPosition(model, data)
    point = data.geom_xpos[tip].copy()
    point[2] -= model.geom_size[tip, 0]
    jacobian = np.empty((3, len(place)))
    mujoco.mj_jac(model, data, jacobian, None, point, int(model.geom_bodyid[tip]))
    slope = 0.0 if ground.tread else ground.grade
    rises = jacobian[2] - slope * jacobian[0]
    return np.concatenate([-rises / max(-float(rises @ rate), _SLOWEST), np.zeros(len(rate))])
