"""How probable a finding is, by experience: odds say how surely a model gains, held-out time says whether its name is right."""

from __future__ import annotations

from exo_sim.diagnosis.findings import Finding, Kind
from exo_sim.diagnosis.outcome.finding_size import may_be_nil
from exo_sim.diagnosis.policy.probability import EVEN_SHARE, LEAST_PROBABILITY, MAY_BE_NIL, STEEPNESS, UNTESTED
from exo_sim.diagnosis.policy.verdicts import CONFIDENT_BESIDE_UNKNOWN, MOST_CONFIDENT


def confidence(finding: Finding, share: float | None, of_doubtful_pressures: bool = False, is_upheld: bool = False) -> float:
    """Return the probability that a finding is so: as weighed or from its odds, and no more than experience with such shares bears.

    Args:
        finding: With its odds.
        share: Of the squared error beyond the noise that is missing without it, what it explains of held-out time; None where its
            predictions do not change there, so that nothing was tested.
        of_doubtful_pressures: Whether it is of forces whose pressures belong to a gas in which something has no name: a sensor behind a
            hose that was not found shows another pressure than the piston feels.
        is_upheld: Whether it was put aside for that share, and taken back because without it more was missed: it is no less probable then
            than what is kept at all.
    """
    most = float(CONFIDENT_BESIDE_UNKNOWN) if of_doubtful_pressures else 1.0
    tested = max(by_share(share), float(LEAST_PROBABILITY)) if is_upheld else by_share(share)
    return min(finding.confidence, tested, float(MAY_BE_NIL) if may_be_nil(finding) else 1.0, most)


def is_weighed_physics(finding: Finding) -> bool:
    """Return whether a finding is physics that was weighed beside others, with intervals over all their laws."""
    return finding.probability is not None and finding.kind is Kind.MISSING_PHYSICS


def by_share(share: float | None) -> float:
    """Return the most that a name is probable which explains this share of held-out time, by experience; `share` as of `confidence`."""
    return float(UNTESTED) if share is None else MOST_CONFIDENT / (1.0 + (EVEN_SHARE / max(share, 1e-3)) ** STEEPNESS)


def is_doubtful(share: float) -> bool:
    """Return whether a finding that explains this share of held-out time is more likely wrong than right, by experience."""
    return by_share(share) < LEAST_PROBABILITY
