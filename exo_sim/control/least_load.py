"""The joint torques for which the straps load the wearer's joints least, over a whole cycle at once.

The machine gives way against straps and ground (`yielding.py`). Strap forces, and with them the wearer's extra moments, are linear in
that, so the best torque harmonics are a linear least-squares problem.

Contact is not linear, gas lags, and what the ground holds up it also tips over. So the solution is then improved by rehearsal, stride by
stride, as iterative learning control does: what the straps really did over a cycle takes the place of the prediction, and least squares
give the correction (norm-optimal learning, Amann, Owens and Rogers 1996), which goes the less far, the less the last ones kept of what they
promised (`step_damping.py`). What a change does is worked out along the best rehearsal so far (`walk_response.py`): with the map of
`yielding.py`, which leaves out what tips over, torques of the lowest harmonics did five times as much as promised, and other things
(mean correlation over the loads 0.53, of the steady torques none; along the walk 0.97; level, 34 kg). Where nobody worked it out, as for a
wearer who is a body, changes go by the map for the feet that carried in the best rehearsal, and where one made it worse by that for those
of the plan. All of these maps learn from what each change did (`learnt_map.py`).
Straps move the centres of pressure under the wearer's soles; where a rehearsal showed these at the edge they go no farther, and the moment
that no sole can give counts beside those of the joints. A plan that knows of no edge relieves the ankle with a force that is not there.
So does what chambers hold with pressure near their rating, as torque (`simulation/chamber_limits.py`), where a rehearsal showed any.

A plan is cut off at what the actuators can hold. Where no spring holds the ankle, feet that stand on heel and toe at once make it ask for
torques that are far beyond that, and what is left of them may be no plan; where a spring does, it may count on feet that do not stand. So
rehearsals may begin with other torques as well (`begun_with`).
"""

from __future__ import annotations

from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.learnt_map import BELIEVED, LearntMap
from exo_sim.control.load_weights import Weights
from exo_sim.control.machine_dynamics import PICK, MachineDynamics
from exo_sim.control.rehearsed import Rehearsed
from exo_sim.control.step_damping import BY_TWO_MAPS, StepDamping
from exo_sim.control.strap_loads import StrapLoads, own_moments
from exo_sim.control.torque_harmonics import basis, basis_at, delayed, fitted
from exo_sim.control.walk_response import WalkResponse
from exo_sim.control.yielding import StrapResponse, Yielding
from exo_sim.gait.motion import SAMPLES, Motion
from exo_sim.machine.person import Person
from exo_sim.machine.straps import StrapSet
from exo_sim.rig.schema import Ankle

#: Harmonics of the torques in a stride or repetition.
HARMONICS = 10
_LIFTINGS = 4


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
        response: How it answers along that; None where nobody worked it out.
    """

    yielding: Yielding
    response: WalkResponse | None
    _shown: LearntMap
    _thought: LearntMap
    _of_straps: LearntMap
    _planned: StrapResponse

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
        self._size = np.tile(np.sum(basis(self._phases, self._harmonics) ** 2, axis=0), len(self.driven))
        self._reach = reach
        self._coefficients = np.zeros(len(self.driven) * (2 * self._harmonics + 1))
        self._solve(dynamics, motion, person, straps, ankle)
        self._coefficients = self._within_reach(self._coefficients)
        self.response, self._exact, self._by_thought = None, False, False
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
        out[:, self.driven] = basis(len(out), self._harmonics) @ coefficients.reshape(len(self.driven), -1).T
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

    def push(self, forces: NDArray[np.float64]) -> float:
        """Return what straps with forces on the machine, across and along [N], shape (n, 2 straps), push it ahead with, the mean [N]."""
        return float((self._strap_loads.sums[:, 2] * forces).sum(axis=1).mean())

    def pushing(self) -> NDArray[np.float64]:
        """Return the change of the harmonics for a newton more of `push` that costs the wearer's joints and the effort least."""
        effect = np.einsum("ns,nsm->m", self._strap_loads.sums[:, 2], self._forces) / self._phases
        change = self._of_straps.gain @ effect
        return np.asarray(change / (effect @ change))

    def strap_forces(self, torques: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the strap forces on the machine that follow from small torques of the driven joints where the machine stands as rehearsed.

        Args:
            torques: At the n even phases of a cycle [N m], shape (n, driven).

        Returns:
            Across and along [N], shape (n, 2 straps).
        """
        return np.asarray(self._forces @ fitted(torques, self._harmonics))

    def later(self, strides: float) -> LeastLoad:
        """Return a plan whose best torques come so much later than these, as if they had been rehearsed."""
        other = copy(self)
        other._coefficients = self._within_reach(delayed(self.best, len(self.driven), strides / self._strides))
        other._best = (self._best[0], other._coefficients)
        return other

    def answering(self, response: WalkResponse) -> LeastLoad:
        """Return a plan that knows how the machine answers along a walk with its best torques."""
        other = copy(self)
        other.response = response
        return other

    def _heard_of(self, seen: Rehearsed) -> NDArray[np.float64]:
        """Return what counts of a rehearsal: weighed loads, then, where rehearsals go by the answer along the walk, chambers' pressures."""
        felt = np.concatenate([seen.moments, seen.residual[:, None], seen.straps], axis=1)
        loads = self._counted((felt + self._own) * self._matters).reshape(-1)
        if seen.response is None or seen.pressed is None:
            return loads
        return np.concatenate([loads, self.weights.pressed * seen.pressed[:, self.driven].reshape(-1)])

    def learn(self, seen: Rehearsed) -> float:
        """Better the torques by what they did in a rehearsal.

        Returns:
            The cost that was reached; `torque(best=True)` belongs to the least of all.
        """
        tried, heard = self._coefficients, self._heard_of(seen)
        cost = float(heard @ heard + (self._effort * tried) @ (self._effort * tried))
        did = (tried - self._best[1], heard - self._heard) if np.isfinite(self._best[0]) else None
        self._exact = seen.response is not None
        if did is None:
            self._damping = StepDamping() if self._exact else BY_TWO_MAPS
        elif not self._exact:
            self._thought = self._thought.updated(*did)
        if cost < self._best[0]:
            self._damping = self._damping.bettered(self._best[0], cost)
            self._best, self._heard = (cost, tried), heard
            self._see(seen)
            if did and not self._exact:
                self._shown = self._shown.updated(*did)
        elif did:
            self._shown = self._shown.updated(*did, believed=1.0 if self._exact else BELIEVED)
            self._missed()
        self._go_on()
        return cost

    def _see(self, seen: Rehearsed) -> None:
        """Take the maps along a rehearsal that was the best so far."""
        damping, stiffness = self._planned.held(seen.contacts)
        self._strap_map = self._of_straps_at(seen.at_edge)
        self.yielding = replace(self.yielding, damping=damping, stiffness=stiffness, load=self._strap_map)
        if seen.response is None:
            self._forces = self._planned.forces(seen.contacts)[0][:, :, :-1]
        else:
            self.response = found = seen.response()
            carried = np.interp(found.phase, np.arange(len(self._support)) / len(self._support), self._support, period=1.0)
            self._forces = found.steady(basis_at(found.phase, self._harmonics) * carried[:, None], self._phases)
        effect = self._counted(self._strap_map @ self._forces).reshape(self._matters.size, -1)
        self._shown = LearntMap(effect, self._effort)
        if self._exact:
            self._of_straps = self._shown
            self._shown = LearntMap(np.concatenate([effect, self._pressing(seen)]), self._effort)

    def _pressing(self, seen: Rehearsed) -> NDArray[np.float64]:
        """Return how chambers' pressures, as they count, answer to the harmonics, shape (n driven or 0, m)."""
        waves = basis(self._phases, self._harmonics) * self._support[PICK, None]
        if seen.presses is None:
            return np.zeros((0, len(self._effort)))
        rows = np.zeros((self._phases, len(self.driven), len(self.driven), waves.shape[1]))
        for i, joint in enumerate(self.driven):
            rows[:, i, i] = self.weights.pressed * seen.presses[:, joint, None] * waves
        return rows.reshape(self._phases * len(self.driven), -1)

    def fell(self) -> bool:
        """Go less far, since a wearer fell with the torques tried last; return whether there was a rehearsal before to go on from."""
        if not np.isfinite(self._best[0]):
            return False
        self._missed()
        self._go_on()
        return True

    def _missed(self) -> None:
        self._by_thought = not self._exact and not self._by_thought
        self._damping = self._damping.missed()

    def _go_on(self) -> None:
        """Choose the torques to try next, from the best so far."""
        best, it = self._best[1], self._thought if self._by_thought else self._shown
        change = it.damped(self._heard, best, lambda effect: self._damping.metric(self._size, effect))
        self._coefficients = self._within_reach(best - change)
        self._damping = replace(self._damping, promised=it.promised(self._heard, best, self._coefficients - best))

    def begun_with(self, torques: NDArray[np.float64]) -> LeastLoad:
        """Return a plan that begins with other torques of the six joints [N m], shape (n, 6), as far as actuators can hold them."""
        again = copy(self)  # what it learns it puts in the place of what was
        again._coefficients = self._within_reach(fitted(torques[:, self.driven], self._harmonics))
        again._best, again._by_thought = (np.inf, self.best), False
        return again

    def _within_reach(self, coefficients: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the harmonics that come closest to the torques cut off at what the actuators can hold."""
        table = basis(self._phases, self._harmonics) @ coefficients.reshape(len(self.driven), -1).T
        return fitted(np.clip(table, self._reach[:, self.driven, 0], self._reach[:, self.driven, 1]), self._harmonics)

    def _solve(self, dynamics: MachineDynamics, motion: Motion, person: Person, straps: StrapSet, ankle: Ankle) -> None:
        """Find the effect of each torque harmonic on the loads, and the harmonics that make the loads least."""
        n = self._phases
        self._strap_loads = StrapLoads.of(dynamics, motion, person, straps)
        self._strap_map = self._of_straps_at(np.zeros(n))
        inputs = np.zeros((n, 6, len(self.driven), 2 * self._harmonics + 1))
        for i, joint in enumerate(self.driven):
            inputs[:, joint, i] = basis(n, self._harmonics) * self._support[PICK, None]
        it, down = StrapResponse(dynamics, motion.period, straps, ankle, inputs.reshape(n, 6, -1)), motion.contact[PICK].copy()
        self._planned = it
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
        self._shown = self._thought = self._of_straps
        self.yielding = Yielding(
            dynamics.inertia, *it.held(carried), it.strap, it.stiffness, it.damping, self._strap_map, tuple(self.driven)
        )

    def _of_straps_at(self, at_edge: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the weighed loads of a unit force of each strap, shape (n, 10, 2 straps), for the phases in which soles give no more."""
        return self._strap_loads.at(at_edge) * self._matters[:, :, None]

    def _counted(self, loads: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return weighed loads, shape (n, 10, ...), with the push that is left over a cycle as it counts."""
        out = loads.copy()
        out[:, -1] += (self.weights.steady - 1.0) * loads[:, -1].mean(axis=0)
        return out
