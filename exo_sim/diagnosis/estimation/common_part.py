"""Parameters of which only the sum with another shows: what they have in common is split as the priors say."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.prior_terms import prior_terms
from exo_sim.physics.declaration import declared


def with_common_parts_split(fit: Fit) -> Fit:
    """Return a fit in which a common part of several parameters stands where the priors want it; its residual is the same.

    Four equal overlaps of a valve's edges are its dead-band: no recording says how much of them is written as the one and how much as
    the other, and a fit moves little along what does not change its residual.
    """
    values = dict(fit.values)
    for whole, parts in _families(fit.parameters):
        shift = _preferred_shift(whole, parts, values)
        for q, value in ((whole, values[whole] + shift), *((part, values[part] - shift) for part in parts)):
            values[q] = value
    if values == fit.values:
        return fit
    rows, jacobian = prior_terms(fit.parameters, values)
    return replace(fit, values=values, penalty=float(rows @ rows), prior_jacobian=jacobian)


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
