"""How far the numbers of a finding lie from those at which it does nothing."""

from __future__ import annotations

import math

from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH
from exo_sim.diagnosis.findings import Estimate, Finding
from exo_sim.physics.declaration import declared, identification_of


def may_be_nil(finding: Finding) -> bool:
    """Return whether the intervals of all its sizes hold the values at which it does nothing."""
    sizes = _sizes(finding)
    return bool(sizes) and all(one.low <= nil <= one.high for one, nil in sizes)


def errors_from_nil(finding: Finding) -> float:
    """Return by how many standard errors, those towards nil, that size of a finding lies from nil that does so most.

    Infinite where it has none.
    """
    errors = [abs(one.value - nil) / max(_towards(nil, one) / HALF_WIDTH, 1e-300) for one, nil in _sizes(finding)]
    return max(errors, default=math.inf)


def _towards(nil: float, one: Estimate) -> float:
    """Return how far the interval of a number reaches towards nil; where it holds that, and may end there by a bound, how far at all."""
    if one.low <= nil <= one.high:
        return max(one.high - one.value, one.value - one.low)
    return one.value - one.low if one.value > nil else one.high - one.value


def _sizes(finding: Finding) -> list[tuple[Estimate, float]]:
    """Return the numbers that say how large a finding is, each with its value at which the effect does nothing.

    A shape (the speed of a dip) is never nil. A richer form of an effect does nothing of its own where its numbers are alike.
    """
    neutral, effect = identification_of(finding.name).neutral, declared().get(finding.name)
    found = []
    for name, one in finding.parameters.items():
        nil = neutral.get(name, 0.0)
        if effect is None or effect.parameter(name).low <= nil:
            found.append((one, nil))
    if effect is None or not effect.absorbs or len(found) < 2:
        return found
    weights = [1.0 / max(one.high - one.low, 1e-300) ** 2 for one, _ in found]
    mean = sum(weight * one.value for weight, (one, _) in zip(weights, found, strict=True)) / sum(weights)
    return [(one, mean) for one, _ in found]
