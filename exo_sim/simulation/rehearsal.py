"""Rehearsing: a few cycles at a time are simulated, and the demand bettered by what the straps did in them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.least_load import LeastLoad
from exo_sim.control.machine_dynamics import PICK
from exo_sim.gait.strides import CONTACT_FORCE
from exo_sim.simulation.walk import Walk
from exo_sim.simulation.wearer_load import by_straps


def cycle_mean(walk: Walk, values: NDArray[np.float64], settling: float) -> NDArray[np.float64]:
    """Return the mean over whole cycles of values at the even phases of `machine_dynamics.PICK`, each over its share of the cycle.

    Args:
        walk: At least `settling` and one more cycle long.
        values: Shape (n, ...), a row each step.
        settling: Cycles at the start that are left out.
    """
    period = walk.motion.period
    phase = walk.time / period
    use = (phase >= settling) & (phase < np.floor(phase[-1] + 1e-6))
    phases = len(walk.motion.position[PICK])
    box = np.floor(phase[use] * phases + 0.5).astype(int) % phases
    total = np.zeros((phases, *values.shape[1:]))
    np.add.at(total, box, values[use])
    count = np.bincount(box, minlength=phases)
    return total / count.reshape(-1, *([1] * (values.ndim - 1)))


def expected_load(walk: Walk, settling: int) -> NDArray[np.float64]:
    """Return what the straps do to the wearer's segments along a cycle, the mean over all after `settling`, shape (n, 7, 3)."""
    n = len(walk.motion.position)
    phase = walk.time / walk.motion.period
    last = int(np.floor(phase[-1] + 1e-6))
    at = settling + np.arange(n * (last - settling)) / n
    rows = walk.wrench.reshape(len(phase), -1)
    values = np.stack([np.interp(at, phase, column) for column in rows.T], axis=1)
    return np.asarray(values.reshape(last - settling, n, *walk.wrench.shape[1:]).mean(axis=0))


def learn_from(plan: LeastLoad, walk: Walk, settling: float) -> float:
    """Better a plan by one rehearsal; return the cost it had."""
    ahead, up = (np.stack([walk.columns[f"{name}.strap_force_{axis}"] for name in walk.straps.names]) for axis in "xz")
    torso = [i for i, name in enumerate(walk.straps.names) if name.startswith("torso")]
    straps = np.stack([ahead[torso].sum(axis=0), up[torso].sum(axis=0), ahead.sum(axis=0)], axis=1)
    moments = cycle_mean(walk, by_straps(walk), settling)
    return plan.learn(moments, cycle_mean(walk, straps, settling), cycle_mean(walk, carrying(walk), settling))


def carrying(walk: Walk) -> NDArray[np.float64]:
    """Return whether heel and toe of the machine's left and right foot carry, 0 or 1, shape (n, 4), a row each step."""
    model, out = walk.model, []
    for side in "lr":
        site = model.site(f"foot_{side}").pos[0]
        heel, toe = (model.geom(f"{name}_{side}").pos[0] - site for name in ("heel", "toe"))
        up, centre = (walk.columns[f"foot_{side}.{name}"] for name in ("ground_force_z", "pressure_centre"))
        of_toe = np.clip((centre - heel) / (toe - heel), 0.0, 1.0)
        out += [up * (1.0 - of_toe) > CONTACT_FORCE, up * of_toe > CONTACT_FORCE]
    return np.stack(out, axis=1).astype(float)
