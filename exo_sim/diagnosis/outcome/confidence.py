"""How probable a finding is, by experience: odds say how surely a model gains, time kept back says whether its name is right."""

from __future__ import annotations

from exo_sim.diagnosis.findings import Finding
from exo_sim.diagnosis.policy.confidence import EVEN_SHARE, LEAST_TOLD, STEEPNESS, UNTESTED
from exo_sim.diagnosis.policy.verdicts import MOST_CONFIDENT


def confidence(finding: Finding, share: float | None) -> float:
    """Return the probability that a finding is so: as weighed or from its odds, and no more than experience with such shares bears.

    Args:
        finding: With its odds.
        share: Of the squared error beyond the noise that is missing without it, what it explains of time kept back; None where its
            predictions do not change there, so that nothing was tested.
    """
    return min(finding.confidence, _borne(share))


def is_doubtful(share: float | None) -> bool:
    """Return whether a name with such a share, as of `confidence`, is more likely wrong than right whatever its odds."""
    return _borne(share) < LEAST_TOLD


def _borne(share: float | None) -> float:
    return float(UNTESTED) if share is None else MOST_CONFIDENT / (1.0 + (EVEN_SHARE / max(share, 1e-3)) ** STEEPNESS)
