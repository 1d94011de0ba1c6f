"""Rehearsing: a few cycles at a time are simulated, and the demand bettered by what the straps did in them."""

from __future__ import annotations

import math
from copy import copy
from functools import partial

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.least_load import LeastLoad
from exo_sim.control.machine_dynamics import PICK
from exo_sim.control.rehearsed import Rehearsed
from exo_sim.gait.motion import Motion
from exo_sim.gait.strides import CONTACT_FORCE
from exo_sim.simulation.chamber_limits import ChamberLimits
from exo_sim.simulation.linearised_walk import linearised
from exo_sim.simulation.walk import Request, Walk
from exo_sim.simulation.wearer_load import own, with_machine

#: Rehearsals go on until so many of them bettered the plan by no more than this share. A step that failed says little: the next is shorter
#: and knows of it.
_LAST, _LITTLE = 12, 0.01
#: What moves by less over a cycle stands still [m or rad]: rounding.
_STILL = 1e-6


def cycle_mean(walk: Walk, values: NDArray[np.float64], settling: float) -> NDArray[np.float64]:
    """Return the mean over whole cycles of values at the even phases of `machine_dynamics.PICK`, each over its share of the cycle.

    Args:
        walk: At least `settling` and one more cycle long.
        values: Shape (n, ...), a row each step.
        settling: Cycles at the start that are left out.
    """
    use = counted(walk, settling)
    return _phase_mean(walk.part(use), values[use])


def _phase_mean(walk: Walk, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return `cycle_mean` of rows that are whole cycles."""
    phases = len(walk.motion.position[PICK])
    box = np.floor(walk.time / walk.motion.period * phases + 0.5).astype(int) % phases
    total = np.zeros((phases, *values.shape[1:]))
    np.add.at(total, box, values)
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


class Rehearsals:
    """Better a plan by rehearsals, one after the other; only the cycles after `settling` are looked at.

    The wearer's motion is prescribed, and the same in every rehearsal: what his own body asks of him is worked out in the first.

    Args:
        plan: What is bettered.
        settling: Cycles at the start of each that are left out.

    Attributes:
        bettered: Cost and plan of each rehearsal that cost less than all before it, as it was then.
    """

    def __init__(self, plan: LeastLoad, settling: float) -> None:
        self.plan, self._settling = plan, settling
        self._least: list[float] = []
        self.bettered: list[tuple[float, LeastLoad]] = []
        self._body: NDArray[np.float64] | None = None
        self._chambers: ChamberLimits | None = None

    @property
    def least(self) -> float:
        """The least cost that a rehearsal had; infinite where there was none."""
        return self._least[-1] if self._least else math.inf

    @property
    def settled(self) -> bool:
        """Whether the last rehearsals bettered the plan by so little that more of them are not worth their time."""
        return len(self._least) > _LAST and self._least[-1] > (1.0 - _LITTLE) * self._least[-1 - _LAST]

    def learn_from(self, walk: Walk) -> float:
        """Better the plan by a rehearsal; return the cost it had. All rehearsals have the same motion and the same rows."""
        cost = self.plan.learn(self._seen(walk))
        if cost < self.least:
            self.bettered.append((cost, copy(self.plan)))  # what it learns it puts in the place of what was
        self._least.append(min([cost, *self._least[-1:]]))
        return cost

    def _seen(self, walk: Walk) -> Rehearsed:
        """Return what a rehearsal showed."""
        seen = walk.part(counted(walk, self._settling))
        ahead, up = (np.stack([seen.columns[f"{name}.strap_force_{axis}"] for name in seen.straps.names]) for axis in "xz")
        torso = [i for i, name in enumerate(seen.straps.names) if name.startswith("torso")]
        straps = np.stack([ahead[torso].sum(axis=0), up[torso].sum(axis=0), ahead.sum(axis=0)], axis=1)
        if self._body is None:
            self._body = own(seen).moments
        it = with_machine(seen)
        held = it.ground
        each = (it.moments - self._body, straps, carrying(seen), held.residual[:, 2], held.outside.astype(float))
        moments, forces, contacts, left, edge = (_phase_mean(seen, one) for one in each)
        # who stands still shifts weight from foot to foot by 200 N with what is found along a cycle in which nothing moves
        along = bool(np.ptp(walk.motion.position, axis=0).max() > _STILL)
        response = partial(linearised, walk, self.plan.driven) if along else None
        return Rehearsed(moments, forces, contacts, left, edge, response, *self._pressed(seen))

    def _pressed(self, seen: Walk) -> tuple[NDArray[np.float64] | None, NDArray[np.float64] | None]:
        """Return `Rehearsed.pressed` and `presses`."""
        if seen.books is None:
            return None, None
        if self._chambers is None:
            self._chambers = ChamberLimits.of(seen.rig, seen.model, seen.motion)
        if not self._chambers.names:
            return None, None
        return self._chambers.torques(*(_phase_mean(seen, each) for each in self._chambers.passed(seen)))


def steps_alike(request: Request, motion: Motion) -> bool:
    """Return whether strides come again, of a wearer who is led by the reference."""
    return request.moved_by == "prescribed" and not motion.from_rest and motion.advance > 0.0


def counted(walk: Walk, settling: float) -> slice:
    """Return the rows of the whole cycles after `settling`."""
    phase = walk.time / walk.motion.period
    return slice(*np.searchsorted(phase, [settling, np.floor(phase[-1] + 1e-6)]).tolist())


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
