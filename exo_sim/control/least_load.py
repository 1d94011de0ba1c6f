"""The joint torques for which the straps load the wearer's joints least, over a whole cycle at once.

The machine gives way against straps and ground (`yielding.py`). Strap forces, and with them the wearer's extra moments, are linear in
that, so the best torque harmonics are a linear least-squares problem.

Contact is not linear, and gas lags. So the solution is then improved by rehearsal, stride by stride, as iterative learning
control does: what the straps really did over a cycle takes the place of the prediction, and the same least squares
give the correction (norm-optimal learning, Amann, Owens and Rogers 1996), which goes the less far, the less the last ones kept of what they
promised (`step_damping.py`). They are those of the heels and toes that carried in the best rehearsal so far; where a step made it worse,
those of the plan's. Both learn from what each change did (`learnt_map.py`).
Straps move the centres of pressure under the wearer's soles; where a rehearsal showed these at the edge they go no farther, and the moment
that no sole can give counts beside those of the joints. A plan that knows of no edge relieves the ankle with a force that is not there.

A plan is cut off at what the actuators can hold. Where no spring holds the ankle, feet that stand on heel and toe at once make it ask for
torques that are far beyond that, and what is left of them may be no plan; where a spring does, it may count on feet that do not stand. So
rehearsals may begin with other torques as well (`begun_with`).
"""

from __future__ import annotations

from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.learnt_map import LearntMap
from exo_sim.control.load_weights import Weights
from exo_sim.control.machine_dynamics import PICK, MachineDynamics
from exo_sim.control.step_damping import StepDamping
from exo_sim.control.strap_loads import StrapLoads, own_moments
from exo_sim.control.yielding import StrapResponse, Yielding
from exo_sim.gait.motion import SAMPLES, Motion
from exo_sim.machine.person import Person
from exo_sim.machine.straps import StrapSet
from exo_sim.rig.schema import Ankle

#: Harmonics of the torques in a stride or repetition.
HARMONICS = 10
_LIFTINGS = 4
#: By how much straps are thought to be less and more stiff.
_OTHERWISE = 0.5, 2.0


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

    Attributes:
        driven: Which of the six joints have a torque.
        yielding: How the machine gives way where its feet are on the ground as in the best rehearsal.
    """

    yielding: Yielding
    _planned: LearntMap
    _responses: list[StrapResponse]
    _share_of_others: float

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
        self.driven = [0, 1, 3, 4] if ankle.mode != "powered" else [0, 1, 2, 3, 4, 5]
        self._support = motion.support
        rate = motion.slope[PICK, 3:] / motion.period
        self._matters = np.maximum(motion.support[PICK], 1e-3)[:, None] * self.weights.of_loads(rate)
        self._own = np.concatenate([self.weights.own * own_moments(motion, person), np.zeros((len(rate), 4))], axis=1)
        self._strides = max(1, len(motion.position) // SAMPLES)
        self._phases, self._harmonics = len(rate), HARMONICS * self._strides
        harmonic = np.concatenate([[0], np.repeat(np.arange(1, self._harmonics + 1), 2)]) / self._strides
        effort = np.tile(np.hypot(self.weights.effort, self.weights.smoothness * harmonic), len(self.driven))
        self._effort: NDArray[np.float64] = effort * float(np.sqrt(self._phases))
        self._size = np.tile(np.sum(_basis(self._phases, self._harmonics) ** 2, axis=0), len(self.driven))
        self._reach = reach
        self._coefficients = np.zeros(len(self.driven) * (2 * self._harmonics + 1))
        self._solve(dynamics, motion, person, straps, ankle)
        self._coefficients = self._within_reach(self._coefficients)
        self._shown, self._by_plan = self._planned, False
        self._best: tuple[float, NDArray[np.float64]] = (np.inf, self._coefficients)
        self._heard = np.zeros(0)
        self._damping = StepDamping()

    @property
    def best(self) -> NDArray[np.float64]:
        """Harmonics of the best rehearsal so far, or those to try first where there was none."""
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
        out[:, self.driven] = _basis(len(out), self._harmonics) @ coefficients.reshape(len(self.driven), -1).T
        return out * self._support[:, None]

    def restored(self, change: NDArray[np.float64], forces: NDArray[np.float64], share: float) -> NDArray[np.float64]:
        """Return a change of the best harmonics that takes the straps back to the forces that belong to them.

        Args:
            change: What it was so far.
            forces: By how much the straps' forces on the machine, across and along, were others [N], shape (n, 2 straps).
            share: Of the full correction, 0 to 1.
        """
        load = self._counted(np.einsum("nij,nj->ni", self._strap_map, forces)).reshape(-1)
        change = change - share * self._of_straps.correction(load, change)
        return self._within_reach(self.best + change) - self.best

    def strap_forces(self, torques: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the strap forces on the machine that follow from small torques of the driven joints where the machine stands as rehearsed.

        Args:
            torques: At the n even phases of a cycle [N m], shape (n, driven).

        Returns:
            Across and along [N], shape (n, 2 straps).
        """
        return np.asarray(self._forces @ self._harmonics_of(torques))

    def learn(
        self,
        moments: NDArray[np.float64],
        straps: NDArray[np.float64],
        contacts: NDArray[np.float64],
        residual: NDArray[np.float64],
        at_edge: NDArray[np.float64],
    ) -> float:
        """Better the torques by what they did in a rehearsal.

        Args:
            moments: The wearer's extra moments at the n even phases of a cycle [N m], shape (n, 6).
            straps: Force of all torso straps, ahead and up, and of all straps ahead, at the same phases [N], shape (n, 3).
            contacts: For what share of each phase each of `machine_dynamics.CONTACTS` carried, shape (n, 4).
            residual: Moment that no sole could give, at the same phases [N m], shape (n,).
            at_edge: For what share of each phase there was one, shape (n,).

        Returns:
            The cost that was reached; `torque(best=True)` belongs to the least of all.
        """
        felt = np.concatenate([moments, residual[:, None], straps], axis=1)
        load = self._counted((felt + self._own) * self._matters).reshape(-1)
        tried, heard = self._coefficients, load
        answer = self._answer(contacts, at_edge) if len(self._responses) > 1 else None
        if answer is not None:
            maps = answer[1]
            others = (self._share_of_others * (load + (one - maps[0]) @ np.append(tried, 1.0)) for one in maps[1:])
            heard = np.concatenate([load, *others])
        cost = float(heard @ heard + (self._effort * tried) @ (self._effort * tried))
        count = len(load)
        did = (tried - self._best[1], load - self._heard[:count]) if np.isfinite(self._best[0]) else None
        if did:
            self._planned = self._planned.updated(*did)
        if cost < self._best[0]:
            forces, maps = answer or self._answer(contacts, at_edge)
            self._damping = self._damping.bettered(self._best[0], cost)
            self._best, self._heard = (cost, tried), heard
            self._shown = self._counting_all(maps)
            if did:
                self._shown = self._shown.updated(*did)
            damping, stiffness = self._responses[0].held(contacts)
            self._forces = forces[0][:, :, :-1]
            self._strap_map = self._of_straps_at(at_edge)
            self.yielding = replace(self.yielding, damping=damping, stiffness=stiffness, load=self._strap_map)
        elif did:
            self._shown = self._shown.updated(*did)
            self._missed()
        self._go_on()
        return cost

    def fell(self) -> bool:
        """Go less far, since a wearer fell with the torques tried last; return whether there was a rehearsal before to go on from."""
        if not np.isfinite(self._best[0]):
            return False
        self._missed()
        self._go_on()
        return True

    def _missed(self) -> None:
        self._by_plan = not self._by_plan
        self._damping = self._damping.missed()

    def _go_on(self) -> None:
        """Choose the torques to try next, from the best so far."""
        best, it = self._best[1], self._planned if self._by_plan else self._shown
        change = it.damped(self._heard, best, lambda effect: self._damping.metric(self._size, effect))
        self._coefficients = self._within_reach(best - change)
        self._damping = replace(self._damping, promised=it.promised(self._heard, best, self._coefficients - best))

    def begun_again(self) -> LeastLoad:
        """Return a plan that goes on from the best torques where rehearsals cost otherwise than before: of another wearer."""
        again = copy(self)  # what it learns it puts in the place of what was
        again._coefficients = self.best
        again._best, again._by_plan, again._damping = (np.inf, again._coefficients), False, StepDamping()
        return again

    def begun_with(self, torques: NDArray[np.float64]) -> LeastLoad:
        """Return a plan that begins with other torques of the six joints [N m], shape (n, 6), as far as actuators can hold them."""
        again = self.begun_again()
        again._coefficients = again._within_reach(again._harmonics_of(torques[:, again.driven]))
        return again

    def _within_reach(self, coefficients: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the harmonics that come closest to the torques cut off at what the actuators can hold."""
        table = _basis(self._phases, self._harmonics) @ coefficients.reshape(len(self.driven), -1).T
        return self._harmonics_of(np.clip(table, self._reach[:, self.driven, 0], self._reach[:, self.driven, 1]))

    def _harmonics_of(self, table: NDArray[np.float64]) -> NDArray[np.float64]:
        basis = _basis(self._phases, self._harmonics)
        return np.asarray(np.linalg.lstsq(basis, table, rcond=None)[0].T.reshape(-1), dtype=np.float64)

    def _solve(self, dynamics: MachineDynamics, motion: Motion, person: Person, straps: StrapSet, ankle: Ankle) -> None:
        """Find the effect of each torque harmonic on the loads, and the harmonics that make the loads least."""
        n = self._phases
        self._strap_loads = StrapLoads.of(dynamics, motion, person, straps)
        self._strap_map = self._of_straps_at(np.zeros(n))
        inputs = np.zeros((n, 6, len(self.driven), 2 * self._harmonics + 1))
        for i, joint in enumerate(self.driven):
            inputs[:, joint, i] = _basis(n, self._harmonics) * self._support[PICK, None]
        others = [straps.stiffened(factor) for factor in _OTHERWISE] if self.weights.other_straps else []
        self._responses = [StrapResponse(dynamics, motion.period, one, ankle, inputs.reshape(n, 6, -1)) for one in (straps, *others)]
        self._share_of_others = float(np.sqrt(self.weights.other_straps))
        it, down = self._responses[0], motion.contact[PICK].copy()
        for _ in range(_LIFTINGS):
            carried = down.astype(float)
            force, give = it.forces(carried)
            self._forces = force[:, :, :-1]
            load = self._counted(self._strap_map @ force).reshape(-1, give.shape[2])
            offset = load[:, -1] + self._counted(self._own * self._matters).reshape(-1)
            self._of_straps = LearntMap(load[:, :-1], self._effort)
            self._coefficients = -self._of_straps.correction(offset, np.zeros(load.shape[1] - 1))
            pulling = down & it.pulled(give @ np.append(self._coefficients, 1.0))
            if not pulling.any():
                break
            down &= ~pulling
        self._planned = self._counting_all(self._maps([one.forces(carried)[0] for one in self._responses], self._strap_map))
        self.yielding = Yielding(
            dynamics.inertia, *it.held(carried), it.strap, it.stiffness, it.damping, self._strap_map, tuple(self.driven)
        )

    def _of_straps_at(self, at_edge: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the weighed loads of a unit force of each strap, shape (n, 10, 2 straps), for the phases in which soles give no more."""
        return self._strap_loads.at(at_edge) * self._matters[:, :, None]

    def _answer(
        self, contacts: NDArray[np.float64], at_edge: NDArray[np.float64]
    ) -> tuple[list[NDArray[np.float64]], list[NDArray[np.float64]]]:
        """Return strap forces and loads that follow from torque harmonics where feet carry so, for straps as they are and otherwise."""
        forces = [one.forces(contacts)[0] for one in self._responses]
        return forces, self._maps(forces, self._of_straps_at(at_edge))

    def _maps(self, forces: list[NDArray[np.float64]], strap_map: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        """Return what loads follow from torque harmonics, the last column without torques, for straps as they are and otherwise."""
        return [self._counted(strap_map @ one).reshape(self._matters.size, -1) for one in forces]

    def _counted(self, loads: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return weighed loads, shape (n, 10, ...), with the push that is left over a cycle as it counts."""
        out = loads.copy()
        out[:, -1] += (self.weights.steady - 1.0) * loads[:, -1].mean(axis=0)
        return out

    def _counting_all(self, maps: list[NDArray[np.float64]]) -> LearntMap:
        """Return the effect of torque harmonics on all loads that count, of straps as they are and otherwise."""
        usual = maps[0][:, :-1]
        beside = np.stack([one[:, :-1] - usual for one in maps[1:]]) if len(maps) > 1 else None
        return LearntMap(usual, self._effort, beside, self._share_of_others)


def _basis(count: int, harmonics: int) -> NDArray[np.float64]:
    """Return constant, cosines and sines of the harmonics at evenly spaced phases, shape (count, 2 harmonics + 1)."""
    phase = np.arange(count) / count
    columns = [np.ones(count)]
    for h in range(1, harmonics + 1):
        columns += [np.cos(2 * np.pi * h * phase), np.sin(2 * np.pi * h * phase)]
    return np.stack(columns, axis=1)
