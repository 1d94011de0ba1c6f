"""Parameters of which only the sum or the product with another shows: what they have in common is split as the priors say."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.estimation.prior_terms import prior_terms
from exo_sim.physics.declaration import declared


def with_common_parts_split(fit: Fit) -> Fit:
    """Return a fit in which a common part of several parameters stands where the priors want it; its residual is the same.

    Four equal overlaps of a valve's edges are its dead-band, four equal sizes of them its area: no recording says how much of them is
    written as the one and how much as the other, and a fit moves little along what does not change its residual.
    """
    return _with_factors_split(_with_sums_split(fit))


def _with_sums_split(fit: Fit) -> Fit:
    values = dict(fit.values)
    for whole, parts in _families(fit.parameters):
        shift = _preferred_shift(whole, parts, values)
        for q, value in ((whole, values[whole] + shift), *((part, values[part] - shift) for part in parts)):
            values[q] = value
    if values == fit.values:
        return fit
    rows, jacobian = prior_terms(fit.parameters, values)
    return replace(fit, values=values, penalty=float(rows @ rows), prior_jacobian=jacobian)


def _with_factors_split(fit: Fit) -> Fit:
    """Return a fit whose factors stand where as few numbers as can be are far from their priors, and those by as little as can be.

    Where edges differ by more than those of any healthy valve, the least squares of priors would make all of them and the valve's area
    wrong, each by a part: the rest of a valve whose exhaust edges are small is as its data sheet says. Of what is within what healthy
    parts show the fit itself says where it stands.
    """
    preferred = [(whole, parts, _preferred_ratio(whole, parts, fit.values)) for whole, parts in _products(fit.parameters)]
    preferred = [one for one in preferred if one[2] != 1.0]
    if not preferred:
        return fit
    values, jacobian = dict(fit.values), fit.jacobian.copy()
    for whole, parts, ratio in preferred:
        for q, by in ((whole, ratio), *((part, 1.0 / ratio) for part in parts)):
            before = values[q]
            values[q] = before * by if q is whole else (1.0 + before) * by - 1.0
            jacobian[:, fit.parameters.index(q)] *= q.slope(values[q]) / (q.slope(before) * by)
    rows, row_jac = prior_terms(fit.parameters, values)
    return replace(fit, values=values, jacobian=jacobian, penalty=float(rows @ rows), prior_jacobian=row_jac)


def _products(parameters: Sequence[FreeParameter]) -> list[tuple[FreeParameter, tuple[FreeParameter, ...]]]:
    """Return every factor that others multiply which may be further off than in any healthy part, with all of those."""
    found = []
    for effect in declared().values():
        factor, names = effect.identification.multiplies
        for whole in (q for q in parameters if factor and q.parameter == factor and q.target is Target.FACTOR):
            parts = [q for q in parameters if (q.effect, q.where) == (effect.name, whole.where) and q.parameter in names]
            unusual = tuple(q for q in parts if q.healthy_limit > 0.0 and q.prior is not None)
            if len(unusual) > 1 and whole.prior is not None:
                found.append((whole, unusual))
    return found


def _preferred_ratio(whole: FreeParameter, parts: Sequence[FreeParameter], values: Mapping[FreeParameter, float]) -> float:
    """Return by what the whole is multiplied, and the parts divided, for the least sum of distances from the priors, within all bounds."""
    means = {q: q.prior[0] for q in (whole, *parts) if q.prior is not None}
    tried = [1.0, means[whole] / values[whole], *((1.0 + values[q]) / (1.0 + means[q]) for q in parts)]

    def apart(ratio: float) -> float:
        moved = {whole: values[whole] * ratio, **{q: (1.0 + values[q]) / ratio - 1.0 for q in parts}}
        if not all(q.low <= value <= q.high for q, value in moved.items()):
            return math.inf
        return sum(abs(value - means[q]) / q.prior[1] for q, value in moved.items() if q.prior is not None)

    best = min(tried, key=apart)
    return best if apart(best) < apart(1.0) else 1.0


def _families(parameters: Sequence[FreeParameter]) -> list[tuple[FreeParameter, tuple[FreeParameter, ...]]]:
    """Return every free parameter that others come on top of, with all of those."""
    by_key = {q.key: q for q in parameters}
    found = []
    for effect in declared().values():
        base, (common, names) = effect.identification.on_top_of, effect.identification.common
        for whole in (q for q in parameters if common and (q.effect, q.parameter) == (base, common)):
            keys = [(effect.name, whole.where, name) for name in names]
            if all(key in by_key for key in keys):
                found.append((whole, tuple(by_key[key] for key in keys)))
    return found


def _preferred_shift(whole: FreeParameter, parts: Sequence[FreeParameter], values: Mapping[FreeParameter, float]) -> float:
    """Return what moves from the parts to the whole with the least square of the priors' residuals, within all bounds."""
    pull = weight = 0.0
    for q, sign in ((whole, -1.0), *((part, 1.0) for part in parts)):
        if q.prior is not None:
            mean, spread = q.prior
            pull += sign * (values[q] - mean) / spread**2
            weight += 1.0 / spread**2
    shift = pull / weight if weight else 0.0
    low = max(whole.low - values[whole], *(values[part] - part.high for part in parts))
    high = min(whole.high - values[whole], *(values[part] - part.low for part in parts))
    return min(max(shift, low), high)
