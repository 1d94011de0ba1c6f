"""What resists a motion as one linear family: dry friction and its features, damping, springs, and what sensors add.

Every law is linear in its size about a contact that slides at a level which is known beforehand; where a law also has a shape (the speed
of Stribeck's dip) there is a term for each of a few. All of them depend on how soon the contact slides, and not linearly: the family
is linearised at a few values of that.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.linear_family import LinearFamily, Linearisation, Term
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy import healthy, priors
from exo_sim.diagnosis.subsystems.motion.law_terms import LawTerms
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.scales import MotionScales
from exo_sim.physics.effects import friction_smoothing, presliding, stribeck_friction

Array = NDArray[np.float64]

#: Softnesses of the dry contact that are tried: travel before a piston slides [m], or a joint [rad].
PISTON_STIFFNESS = (5.5e5, 4e5, 3e5, 2e5, 1e5, 5e4, 2.5e4, 1.2e4, 6e3)
JOINT_TRAVEL = (2e-3, 5e-3, 1e-2, 3e-2)
#: Speeds at which friction has built up that are tried, between these shares of the least and the greatest speed that occurred.
CREEPS, CREEP_LOW, CREEP_HIGH = 6, 0.3, 0.05
#: Effects that say how a contact begins to slide: every law of dry friction depends on that, and not linearly.
_CONTACT_LAWS = (presliding.EFFECT.name, friction_smoothing.EFFECT.name)
#: What friction may depend on that no effect of the list says: place and time.
UNNAMED = ("position", "time")


def motion_family(
    model: MotionModel, nuisances: Sequence[FreeParameter], candidates: Sequence[Candidate], soft: bool = True,
    contacts: Sequence[Mapping[FreeParameter, float]] = (), is_spent: IsSpent = never,
) -> LinearFamily:
    """Return the family of a balance of forces.

    Args:
        model: The balance.
        nuisances: Its nuisance parameters; those that are a candidate's number are left to the candidate.
        candidates: What may be present.
        soft: Whether contacts that do not slide at once are in it.
        contacts: Numbers of the law by which its contact begins to slide, where that is known; the likeliest first.
        is_spent: Whether the time is up: then no more of them are.
    """
    asked = {q.slot for candidate in candidates for q in candidate.parameters}
    free = tuple(q for q in nuisances if q.prior is not None and q.slot not in asked)
    return _Builder(model, free, candidates).family(soft, contacts, is_spent)


class _Builder:
    """The family of one balance."""

    def __init__(self, model: MotionModel, nuisances: tuple[FreeParameter, ...], candidates: Sequence[Candidate]):
        self.model, self.nuisances, self.candidates = model, nuisances, candidates
        self.run, self.scales = model.runs[0], MotionScales.of(model)
        self.unnamed = self._of_place_and_time(model.friction / model.noise if model.noise else 1.0)
        self.laws = LawTerms(model, nuisances, candidates, self.scales)

    def family(self, soft: bool, contacts: Sequence[Mapping[FreeParameter, float]], is_spent: IsSpent) -> LinearFamily:
        linearisations = [] if contacts else [self._linearised(None, {})]
        for candidate in self.candidates if soft else ():
            if candidate.effect in _CONTACT_LAWS:
                known = [values for values in contacts if set(values) == set(candidate.parameters)]
                tried = known if contacts else self._tried(candidate)
                for values in tried:
                    if not linearisations or not is_spent():
                        linearisations.append(self._linearised(candidate, values, len(tried)))
        noise = self.model.noise or math.inf
        whole, least = self.model.friction / noise, self.model.healthy_friction / noise
        return LinearFamily(
            self.nuisances, tuple(linearisations), whole, least, self.laws.fitted_forms(), self.model.constant_of_zeros
        )

    def _of_place_and_time(self, friction: float) -> list[Term]:
        """Return friction that varies with place or time by more than a healthy machine's, as functions of no particular form.

        Args:
            friction: Size of all friction that acts, in units of the noise of a row.
        """
        basis, found = self.model.discrepancy_basis(), []
        for kind, name in enumerate(basis.names):
            columns = basis.columns[:, basis.kinds == kind]
            if name == "time":  # what warms loses its viscous friction as well
                columns = np.hstack([columns, columns * (self.model.speed / max(float(np.mean(self.model.speed)), 1e-12))[:, None]])
            if name in UNNAMED and columns.shape[1]:
                candidate = Candidate(name, self.model.where, name, (), ((),), kind=Kind.UNKNOWN, prevalence=priors.UNNAMED)
                spread = np.full(columns.shape[1], healthy.UNNAMED_FRICTION * friction)
                found.append(Term(candidate, columns, spread, (False,) * columns.shape[1], lambda sizes, before: {}, f"unnamed {name}"))
        return found

    def _tried(self, candidate: Candidate) -> list[Mapping[FreeParameter, float]]:
        """Return the values at which an effect on the contact is tried."""
        (parameter,) = candidate.parameters
        turning = self.run.turning and self.run.cylinder is None
        if candidate.effect == friction_smoothing.EFFECT.name:
            low, high = CREEP_LOW * self.scales.slowest, CREEP_HIGH * self.scales.fastest
            values = list(np.geomspace(low, max(high, 1.01 * CREEP_LOW * self.scales.slowest), CREEPS))
        else:
            values = [self.scales.level / travel for travel in JOINT_TRAVEL] if turning else list(PISTON_STIFFNESS)
        return [{parameter: value} for value in values if parameter.low < value < parameter.high]

    def _linearised(self, candidate: Candidate | None, values: Mapping[FreeParameter, float], alternatives: int = 1) -> Linearisation:
        residual = partial(self.model.residual, fixed=tuple(values.items()))
        nominal = residual({})
        columns = []
        for q in self.nuisances:
            mean, spread = q.prior or (0.0, 1.0)
            columns.append(residual({q: mean + spread}) - nominal)
        background = np.column_stack(columns) if columns else np.zeros((nominal.size, 0))
        terms = [term for one in self.candidates if one.effect not in _CONTACT_LAWS for term in self.laws.terms(one, residual)]
        terms += self.unnamed
        # a term that hangs on others' numbers comes behind them
        terms.sort(key=lambda term: term.candidate.effect == stribeck_friction.EFFECT.name)
        return Linearisation(candidate, values, -nominal, background, tuple(terms), alternatives)
