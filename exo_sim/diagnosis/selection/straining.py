"""Effects of a fit that stand only beside other numbers that are further off with them than without."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.prior_terms import prior_terms
from exo_sim.diagnosis.nominal_numbers import FORCE_OFFSET
from exo_sim.diagnosis.policy.off_nominal import STRAINING
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.simpler_forms import poorer_than, sizes_of_poorer
from exo_sim.physics.declaration import family_of, identification_of


def without_straining(plain: FittedModel, fits: ModelFits, asked: Mapping[str, Candidate] = MappingProxyType({})) -> FittedModel:
    """Return a plain fit without the effects that explain no more than a healthy machine leaves, and only beside numbers further off.

    What the noise explains is no reason for one: friction of two directions and a spring's rest that is off pull against each other, and
    what they do together is less than either. Nor is what the known laws of an effect's own family get wrong in their form: drag beside a
    known film makes up for a dip of another shape, where the film is bent for it as much the other way. A law that is really missing
    leaves the known ones nearer to what their owner says of them. Friction of two directions gives way to that of one where a constant
    force that no sensor makes stands against it.

    One goes at a time, the one that moves the nuisance parameters most.

    Args:
        plain: The fit.
        fits: Fits of its subsystem.
        asked: Candidates by effect, the poorer forms among them that take the place of richer ones.
    """
    while True:
        strained = []
        for candidate in (c for c in plain.candidates if not c.is_law):
            without = _without(candidate, plain, fits, asked)
            rise = plain.fit.penalty - without.fit.penalty
            if rise > STRAINING and _is_left_to_others(candidate, plain, without, fits):
                strained.append((rise, without))
        if not strained:
            return plain
        plain = fits.refined(max(strained, key=lambda pair: pair[0])[1])


def _without(candidate: Candidate, plain: FittedModel, fits: ModelFits, asked: Mapping[str, Candidate]) -> FittedModel:
    """Return the fit without an effect, its poorer form in its place where there is one."""
    poorer = tuple(asked[name] for name in poorer_than(candidate.effect) if name in asked)
    kept = drop_orphans((*plain.without(candidate), *poorer))
    if not poorer:
        return fits.fit(kept, plain)
    return fits.fit(kept, FittedModel.at({**plain.fit.values, **sizes_of_poorer((candidate,), poorer, plain.fit.values)}))


def _is_left_to_others(candidate: Candidate, plain: FittedModel, without: FittedModel, fits: ModelFits) -> bool:
    """Return whether what is left without an effect is noise, or what the known laws of its family may get wrong and are bent for."""
    if without.fit.sse <= fits.model.size:
        return True
    if without.fit.sse > fits.model.discrepancy_bound**2 * fits.model.size:
        return False
    family = family_of(candidate.effect)
    known = [q for q in fits.nuisances if (family and family_of(q.effect) == family) or _is_the_constant_force_beside(q, candidate)]
    return _strain(plain, known) - _strain(without, known) > STRAINING


def _is_the_constant_force_beside(parameter: FreeParameter, candidate: Candidate) -> bool:
    """Return whether a number is the constant force beside which a poorer effect looks like this one."""
    return parameter.effect == FORCE_OFFSET and bool(identification_of(candidate.effect).twins.beside_constant)


def _strain(fitted: FittedModel, known: Sequence[FreeParameter]) -> float:
    """Return by how much known numbers are off, the sum of their squares in standard deviations.

    What is found has priors of its own, such as the shape of a dip: they are no numbers that anybody knows.
    """
    away, _ = prior_terms(known, fitted.fit.values)
    return float(away @ away)
