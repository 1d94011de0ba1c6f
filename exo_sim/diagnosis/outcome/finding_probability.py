"""How probable a finding is, by experience: odds say how surely a model gains, time kept back says whether its name is right."""

from __future__ import annotations

import math

from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.policy.probability import EVEN_SHARE, LEAST_ERRORS, LEAST_PROBABILITY, MAY_BE_NIL, STEEPNESS, UNTESTED
from exo_sim.diagnosis.policy.verdicts import CONFIDENT_BESIDE_UNKNOWN, MOST_CONFIDENT
from exo_sim.physics.declaration import declared, identification_of


def confidence(finding: Finding, share: float | None, of_doubtful_pressures: bool = False) -> float:
    """Return the probability that a finding is so: as weighed or from its odds, and no more than experience with such shares bears.

    Args:
        finding: With its odds.
        share: Of the squared error beyond the noise that is missing without it, what it explains of time kept back; None where its
            predictions do not change there, so that nothing was tested.
        of_doubtful_pressures: Whether it is of forces whose pressures belong to a gas in which something has no name: a sensor behind a
            hose that was not found shows another pressure than the piston feels.
    """
    vague = _is_weighed_physics(finding) and _may_be_nil(finding)
    most = float(CONFIDENT_BESIDE_UNKNOWN) if of_doubtful_pressures else 1.0
    return min(finding.confidence, _borne(share), float(MAY_BE_NIL) if vague else 1.0, most)


def doubt(finding: Finding, share: float | None, compared: bool = True) -> str:
    """Return why a name is more likely wrong than right whatever its odds, "" where nothing says so.

    Odds alone do not do: where time kept back tests nothing and the number may be nil, neither speaks for the name. A sensor that is off
    is off at all times: one that time kept back does not show stands in for something else. Where laws that fit as well leave a number
    anywhere about nil, the law is in doubt and not the number alone.

    Args:
        finding, share: As of `confidence`.
        compared: Whether there was time kept back with its signals.
    """
    if _is_weighed_physics(finding) and _errors_from_nil(finding) < LEAST_ERRORS:
        return "laws of what the rig has that fit as well need none of it: its number is smaller than its own standard error"
    if share is None:
        untested = "time that no number was fitted to does not test it"
        if compared and finding.kind is Kind.SENSOR:
            return f"{untested}, where a sensor at fault would be as much at fault as before"
        return f"{untested}, and the interval of its number holds nil" if _may_be_nil(finding) else ""
    if _borne(share) >= LEAST_PROBABILITY:
        return ""
    return (
        f"it explains {100 * share:.0f} % of what is missing without it, on time that no number was fitted to: "
        "names that explain so little are mostly wrong"
    )


def _may_be_nil(finding: Finding) -> bool:
    """Return whether the intervals of all its sizes hold the values at which it does nothing."""
    sizes = _sizes(finding)
    return bool(sizes) and all(one.low <= nil <= one.high for one, nil in sizes)


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


def _is_weighed_physics(finding: Finding) -> bool:
    """Return whether a finding is physics that was weighed beside others, with intervals over all their laws."""
    return finding.probability is not None and finding.kind is Kind.MISSING_PHYSICS


def _errors_from_nil(finding: Finding) -> float:
    """Return by how many standard errors that size of a finding lies from nil that does so most; infinite where it has none."""
    errors = [
        abs(one.value - nil) / max(max(one.high - one.value, one.value - one.low) / HALF_WIDTH, 1e-300) for one, nil in _sizes(finding)
    ]
    return max(errors, default=math.inf)


def _borne(share: float | None) -> float:
    return float(UNTESTED) if share is None else MOST_CONFIDENT / (1.0 + (EVEN_SHARE / max(share, 1e-3)) ** STEEPNESS)
