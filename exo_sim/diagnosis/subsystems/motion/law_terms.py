"""Laws of resistance as terms of a linear family: dry friction and its features, damping, springs, and what sensors add.

Each is differenced about a contact that slides; a law that also has a shape (the speed of Stribeck's dip) has a term for each of a few.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.linear_family import Term
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.estimation.prior_terms import prior_terms
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy import priors
from exo_sim.diagnosis.policy.acceptance import SURELY_MORE
from exo_sim.diagnosis.subsystems.motion.full_scale import full_force, full_travel
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.scales import MotionScales
from exo_sim.physics.declaration import declared
from exo_sim.physics.effects import coulomb_friction, pressure_dependent_friction, return_spring, stribeck_friction

Array = NDArray[np.float64]
Values = Mapping[FreeParameter, float]
Residual = Callable[[dict[FreeParameter, float]], Array]

#: Speeds of Stribeck's dip that are tried, between these shares of the least and the greatest speed that occurred; its exponents.
DIPS, DIP_LOW, DIP_HIGH = 11, 0.7, 0.2
EXPONENTS = (0.6, 1.0, 2.0)
#: Values of a shape without a unit that are tried, such as the power of speed that a film resists with.
POWERS = 3
#: Dry laws are differenced by this share of the level of friction.
STEP = 0.3


class LawTerms:
    """The terms of one balance's laws.

    Args:
        model: The balance.
        nuisances: Its nuisance parameters.
        candidates: All laws that are asked.
        scales: Of the balance.
    """

    def __init__(self, model: MotionModel, nuisances: Sequence[FreeParameter], candidates: Sequence[Candidate], scales: MotionScales):
        self.model, self.nuisances, self.candidates, self.scales = model, nuisances, candidates, scales
        self.run = model.runs[0]
        self.standing_level = self._standing_level(scales.most_pressure)
        self._level = FreeParameter(coulomb_friction.EFFECT.name, model.where, "force", "N", Target.CYLINDER, 1.0, 0.0, 1e9)

    def terms(self, candidate: Candidate, residual: Residual) -> list[Term]:
        """Return the terms of a law about a contact that slides; none where this recording does not show it.

        Args:
            candidate: The law.
            residual: Of the balance by its parameters, at one softness of the contact.
        """
        if candidate.effect == stribeck_friction.EFFECT.name:
            return self._dips(candidate, residual)
        if candidate.effect == return_spring.EFFECT.name:
            return self._spring(candidate, residual)
        if candidate.effect == pressure_dependent_friction.EFFECT.name:
            return self._of_pressure(candidate, residual)
        return self._in_proportion(candidate, residual)

    def _of_pressure(self, candidate: Candidate, residual: Residual) -> list[Term]:
        """Return one form of friction that grows with pressure, where pressure varies; of two that are the same here the first."""
        forms = [one for one in self.candidates if one.effect == candidate.effect]
        if not self.scales.has_pressure or (candidate is not forms[0] and not self.scales.two_pressures):
            return []
        alternatives = len(forms) if self.scales.two_pressures else 1
        return [replace(term, alternatives=alternatives) for term in self._in_proportion(candidate, residual)]

    def _about(self, residual: Residual) -> tuple[dict[FreeParameter, float], Array]:
        """Return the parameters about which terms are formed, a contact that slides, and the residual there."""
        about = {self._level: self.scales.level}
        return about, residual(about)

    def _in_proportion(self, candidate: Candidate, residual: Residual) -> list[Term]:
        never_nil = [q for q in candidate.parameters if q.low > q.neutral]
        if never_nil:
            return self._shaped(candidate, never_nil, residual)
        about, base = self._about(residual)
        columns = []
        for q in candidate.parameters:
            step = self._step(q)
            changed = {**about, q: self.scales.level + step} if q.slot == self._level.slot else {**about, q: q.neutral + step}
            if q.slot == self._level.slot:
                changed.pop(self._level)
            columns.append((residual(changed) - base) / step)
        hidden = [q for q, column in zip(candidate.parameters, columns, strict=True) if not _shows(column)]
        if hidden:
            return self._shaped(candidate, hidden, residual)
        known = self._known_of(self._absorbed(candidate))
        if known is not None:
            return [self._about_known(candidate, known, columns)]
        one_sided = tuple(q.low >= q.neutral for q in candidate.parameters)

        def parameters(sizes: Array, before: Values) -> dict[FreeParameter, float]:
            return {q: q.neutral + float(size) for q, size in zip(candidate.parameters, sizes, strict=True)}

        group, spread = self._group(candidate), self._spread(columns)
        if candidate.kind is Kind.SENSOR:  # the gas may know that it is not off as far
            group, spread = candidate.kind.value, np.minimum(spread, [(q.high - q.neutral) / SURELY_MORE for q in candidate.parameters])
        return [Term(candidate, np.column_stack(columns), spread, one_sided, parameters, group)]

    def _about_known(self, candidate: Candidate, known: FreeParameter, columns: Sequence[Array]) -> Term:
        """Return what the richer form of an effect that the rig has tells apart, about the number that is fitted of the poorer one.

        Args:
            candidate: The richer form, of two numbers.
            known: The poorer form's number, a nuisance parameter.
            columns: What each of the two adds.
        """
        first, second = candidate.parameters
        apart = columns[0] - columns[1]

        def parameters(sizes: Array, before: Values) -> dict[FreeParameter, float]:
            level, half = before[known], float(sizes[0])
            return {first: max(level + half, 0.0), second: max(level - half, 0.0)}

        return Term(candidate, apart[:, None], self._spread([apart]), (False,), parameters, self._group(candidate))

    def _shaped(
        self, candidate: Candidate, hidden: Sequence[FreeParameter], residual: Residual
    ) -> list[Term]:
        """Return a term for each of a few shapes of a law; its shape are parameters that cannot be nil, or show nothing alone.

        None where they show nothing beside a size either: then no motion of this recording asks for them.
        """
        sizes = [q for q in candidate.parameters if q not in hidden]
        about, base = self._about(residual)
        terms = []
        for shape in itertools.product(*(self._shapes(q) for q in hidden)):
            fixed = dict(zip(hidden, shape, strict=True))
            columns = [(residual({**about, **fixed, q: q.neutral + self._step(q)}) - base) / self._step(q) for q in sizes]

            def parameters(amplitudes: Array, before: Values, fixed: Values = fixed) -> dict[FreeParameter, float]:
                return {**fixed, **{q: q.neutral + float(size) for q, size in zip(sizes, amplitudes, strict=True)}}

            if columns and all(_shows(column) for column in columns):
                one_sided = tuple(q.low >= q.neutral for q in sizes)
                terms.append(
                    Term(
                        candidate, np.column_stack(columns), self._spread(columns), one_sided, parameters, candidate.effect,
                        log_prior=_log_prior(fixed),
                    )
                )  # fmt: skip
        differ = any(_shows(one.columns - terms[0].columns) for one in terms)
        return [replace(term, alternatives=len(terms)) for term in terms] if differ else []

    def _shapes(self, parameter: FreeParameter) -> list[float]:
        """Return the values at which a shape is tried: speeds among those that occurred, else over its typical range."""
        low, high = parameter.low, parameter.high
        number = POWERS if parameter.unit == "1" else DIPS
        if parameter.unit in ("m/s", "rad/s"):
            low, high = max(low, DIP_LOW * self.scales.slowest), min(high, self.scales.fastest)
        elif parameter.effect in declared():
            low, high = declared()[parameter.effect].parameter(parameter.parameter).typical
        return list(np.geomspace(low, high, number) if 0.0 < low < high else np.linspace(low, high, number))

    @staticmethod
    def _absorbed(candidate: Candidate) -> str:
        """Return the effect of which this one is the richer form, "" where there is none."""
        effect = declared().get(candidate.effect)
        return effect.absorbs[0][0] if effect and effect.absorbs else ""

    def _known_of(self, effect: str) -> FreeParameter | None:
        """Return the nuisance parameter that says how large an effect is which the nominal machine has; None where it has not."""
        return next((q for q in self.nuisances if q.effect == effect and q.prior is not None and q.prior[0] > 0.0), None)

    def _group(self, candidate: Candidate) -> str:
        """Return the group of an effect: that of the effect of which it is the richer form."""
        return self._absorbed(candidate) or candidate.effect

    def _step(self, parameter: FreeParameter) -> float:
        """Return by how much a parameter is changed to see what it does: enough for a share of the level of friction."""
        force = STEP * self.scales.level
        speed = float(self.scales.fastest)
        steps = {
            "N": force, "N*m": force, "N s/m": force / speed, "N*m*s/rad": force / speed, "N s^2/m^2": force / speed**2,
            "N*m*s^2/rad^2": force / speed**2, "m^2": force / max(self.scales.pressure, 1.0),
        }  # fmt: skip
        return steps.get(parameter.unit, parameter.scale) if parameter.effect in declared() else parameter.scale

    def _spread(self, columns: Sequence[Array]) -> Array:
        """Return the standard deviation of sizes with which each column would make up all that is missing."""
        return np.array([self.scales.size / float(np.sqrt(np.mean(column**2))) for column in columns])

    def _dips(self, candidate: Candidate, residual: Residual) -> list[Term]:
        """Return Stribeck's excess over the level of dry friction, at several speeds of its dip; of a dip with a tail none."""
        if _has_tail(candidate):
            return []
        about, base = self._about(residual)
        candidate = self._believable(candidate)
        breakaway, velocity, exponent = candidate.parameters
        step, most = STEP * self.scales.level, priors.BREAKAWAY * self.scales.level
        sliding, found = self._sliding, []
        low, high = DIP_LOW * self.scales.slowest, DIP_HIGH * self.scales.fastest
        speeds = np.geomspace(low, max(high, 1.01 * DIP_LOW * self.scales.slowest), DIPS)
        for speed, power in itertools.product(map(float, speeds), EXPONENTS):
            shape = {velocity: speed, exponent: power}
            flat = residual({**about, breakaway: sliding, **shape}) if self.standing_level > 0.0 else base
            column = (residual({**about, breakaway: sliding + step, **shape}) - flat) / step
            if not _shows(column):
                continue

            def parameters(sizes: Array, before: Values, shape: Values = shape) -> dict[FreeParameter, float]:
                return {breakaway: self._level_of(before) + max(float(sizes[0]), 0.0), **shape}

            found.append((column, parameters, _log_prior(shape)))
        return [
            Term(
                candidate, column[:, None], np.minimum(self._spread([column]), most), (True,), parameters, candidate.effect, len(found),
                prior,
            )
            for column, parameters, prior in found
        ]  # fmt: skip

    @property
    def _sliding(self) -> float:
        """All dry friction that slides, that of the nominal machine beside Coulomb's among it: a breakaway below that is none."""
        return self.scales.level + self.standing_level

    def _believable(self, dip: Candidate) -> Candidate:
        """Return a dip whose breakaway is about as high as seals have it: below all speeds that occurred it is not seen."""
        prior = (self._sliding, priors.BREAKAWAY * self._sliding)
        return replace(dip, parameters=(replace(dip.parameters[0], prior=prior), *dip.parameters[1:]))

    def fitted_forms(self) -> tuple[Candidate, ...]:
        """Return the forms of laws that have no terms: dips with a tail, which are fitted where a dip without one was found."""
        dips = (one for one in self.candidates if one.effect == stribeck_friction.EFFECT.name)
        return tuple(self._believable(one) for one in dips if _has_tail(one))

    def _standing_level(self, pressure: float) -> float:
        """Return the most dry friction that the nominal machine has beside Coulomb's, at this pressure above the atmosphere [Pa]."""
        record = self.model.nominal.cylinder
        level = float(record[pressure_dependent_friction.EFFECT.name]["coefficient"][0]) * pressure
        richer = (declared()[name] for name in _richer_than(coulomb_friction.EFFECT.name))
        return level + max((float(record[one.name][part.name][0]) for one in richer for part in one.parameters), default=0.0)

    def _level_of(self, values: Values) -> float:
        """Return the level of dry friction that slides, at the pressures that are usual."""
        level, parts = 0.0, {q.key[::2]: value for q, value in values.items()}
        names = coulomb_friction.EFFECT.name, pressure_dependent_friction.EFFECT.name
        record = self.model.nominal.cylinder
        level += parts.get((names[0], "force"), float(record[names[0]]["force"][0]))
        level += parts.get((names[1], "coefficient"), float(record[names[1]]["coefficient"][0])) * self.scales.pressure
        richer = [value for (effect, name), value in parts.items() if effect in _richer_than(names[0])]
        return level + (sum(richer) / len(richer) if richer else 0.0)

    def _spring(self, candidate: Candidate, residual: Residual) -> list[Term]:
        """Return a spring by its stiffness and by its force in the middle of the travel, both of which the balance is linear in.

        Where it is slack follows from both, and may lie far outside the travel: springs are preloaded.
        """
        stiffness, rest = (next(q for q in candidate.parameters if q.parameter == name) for name in ("stiffness", "rest"))
        about, base = self._about(residual)
        near, far = full_travel(self.run, self.model.nominal)
        middle = min(max(0.5 * (near + far), rest.low), rest.high)
        aside = rest.high if rest.high - middle > middle - rest.low else rest.low
        step = STEP * self.scales.level / self.scales.travel
        slack = residual({**about, stiffness: step, rest: middle})
        loaded = residual({**about, stiffness: step, rest: aside})
        columns = [(slack - base) / step, (loaded - slack) / (step * (aside - middle))]

        def parameters(sizes: Array, before: Values) -> dict[FreeParameter, float]:
            stiff = max(float(sizes[0]), 0.0)
            place = middle + float(sizes[1]) / stiff if stiff > 0.0 else middle
            return {stiffness: stiff, rest: min(max(place, rest.low), rest.high)}

        if not _shows(columns[0]):
            return []
        full = full_force(self.run, self.model.nominal) / self.run.drive.usual_arm
        spread = np.maximum(self._spread(columns), [0.0, full])  # a spring is preloaded against all that drives
        return [Term(candidate, np.column_stack(columns), spread, (True, False), parameters, candidate.effect)]


def _has_tail(dip: Candidate) -> bool:
    """Return whether a dip falls more slowly than its exponent says: what that shows beside the nearest exponent is for a fit to say."""
    return any(q.parameter == "tail" for q in dip.parameters)


def _log_prior(shape: Values) -> float:
    """Return the logarithm of how much less probable a shape is than the one that is expected."""
    away, _ = prior_terms(tuple(shape), shape)
    return -0.5 * float(away @ away)


def _richer_than(name: str) -> set[str]:
    """Return the effects that are richer forms of one."""
    return {effect.name for effect in declared().values() if any(absorbed == name for absorbed, _ in effect.absorbs)}


def _shows(column: Array) -> bool:
    """Return whether a column is finite and not nil."""
    return bool(column.size) and bool(np.isfinite(column).all()) and float(np.abs(column).max()) > 0.0
