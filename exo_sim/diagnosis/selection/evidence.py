"""How much better one fitted model explains the data than another, and whether that is enough for a finding.

The evidence counts n / tau independent rows, tau the integrated autocorrelation time of the residual: the errors of a model that misses
something are correlated over long stretches.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from exo_sim.diagnosis.estimation.correlation import Blocked, correlation_time
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.noise_model import noise_model
from exo_sim.diagnosis.policy import acceptance
from exo_sim.recording.noise import white_noise


@dataclass(frozen=True)
class Evidence:
    """How much better one model is than another.

    Attributes:
        log10_odds: Bayes factor (Schwarz approximation) on independent rows, corrected for the number of candidates.
        gain: Difference in log-likelihood on independent rows.
        share: Part of the explainable error that it explains.
        steady: Mean gain over blocks in units of its standard error.
        beside_discrepancy: As `log10_odds`, beside an ARMA(1,1) process that stands for noise and for what the richer model still misses:
            a shape of its own counts however small its share is, and what looks like the rest of the error counts for nothing.
    """

    log10_odds: float
    gain: float
    share: float
    steady: float
    beside_discrepancy: float = 0.0


def misfit(variance: float) -> float:
    """Return twice the negative log-likelihood a row for a residual variance in units of the noise.

    Above the noise the level of the errors is unknown and its logarithm counts; below it the noise is known.
    """
    return math.log(variance) if variance > 1.0 else variance - 1.0


def negative_log_likelihood(fit: Fit, effective_rows: float) -> float:
    """Return the negative log-likelihood of a fit on so many independent rows, the priors included."""
    return 0.5 * effective_rows * misfit(fit.sse / max(fit.residual.size, 1)) + 0.5 * fit.penalty


def price_of_parameter(rows: float) -> float:
    """Return the log-likelihood that a parameter must bring on so many independent rows (Schwarz 1978)."""
    return 0.5 * math.log(max(rows, 2.0))


def compare(rows: Blocked, without: Fit, with_it: Fit, added: int, candidates: int) -> Evidence:
    """Return how much better `with_it` explains the training data than `without`.

    Args:
        rows: Whose rows they are.
        without, with_it: The fits.
        added: By how many parameters the second is richer.
        candidates: How many could have been added.
    """
    n = rows.size
    a, b = without.sse, with_it.sse
    effective = n / correlation_time(with_it.residual, rows.blocks)
    gain = negative_log_likelihood(without, effective) - negative_log_likelihood(with_it, effective)
    odds = (gain - added * price_of_parameter(effective)) / math.log(10.0) - math.log10(max(candidates, 1))
    explainable = max(a - min(n, b), 1e-12)
    per_block = np.bincount(rows.blocks, weights=without.residual**2 - with_it.residual**2)
    gains = per_block[np.bincount(rows.blocks) > 0]
    error = float(gains.std(ddof=1)) / math.sqrt(gains.size) if gains.size > 1 else math.inf
    steady = float(gains.mean()) / error if error > 0.0 else math.inf
    beside = _beside_discrepancy(rows, without, with_it, added) - math.log10(max(candidates, 1))
    return Evidence(odds, gain, max(a - b, 0.0) / explainable, steady, beside)


def _beside_discrepancy(rows: Blocked, without: Fit, with_it: Fit, added: int) -> float:
    """Return log10 of the odds between two fits, both residuals whitened by the error process of the richer one."""
    process = noise_model(with_it.residual, rows.blocks)
    poorer, richer = process.whitened(without.residual), process.whitened(with_it.residual)
    gain = 0.5 * float(poorer @ poorer - richer @ richer) + 0.5 * (without.penalty - with_it.penalty)
    return (gain - added * price_of_parameter(rows.size)) / math.log(10.0)


def has_own_shape(evidence: Evidence) -> bool:
    """Return whether an effect has a shape of its own beside what is still missed, and gains all the time, however little."""
    return evidence.beside_discrepancy > acceptance.BESIDE_DISCREPANCY and evidence.steady > acceptance.STEADY_GAIN


def is_accepted(
    evidence: Evidence, baseline: Fit, without: Fit, with_it: Fit, practical_significance: float, stands: bool = False
) -> bool:
    """Return whether a candidate passes every gate.

    What is practically significant counts, and what is beyond doubt: of an error that is above the noise, or of any where it has a shape
    of its own. Once nine tenths are explained, a further effect must reach the noise or take half of what is left: the last tenth of a
    real machine has no particular shape, and every candidate fits a little of it. What has a shape of its own and returns the rig's
    numbers to their data sheets need do neither: they lower the error in its place. Where no more than the noise is left, nothing else is
    a gain: noise that was taken to be larger than it is counts what happened between samples too, and any candidate fits a little of
    that.

    Args:
        evidence: For it.
        baseline: The fit of the nuisance parameters alone.
        without, with_it: The fits that were compared.
        practical_significance: Drop of the root mean square residual below which a candidate must be beyond doubt.
        stands: Whether it stands in a model already: then it stays however small its share is, if a shape of its own shows.
    """
    n, own_shape = max(without.residual.size, 1), has_own_shape(evidence)
    if without.penalty - with_it.penalty > acceptance.RELIEF and own_shape:
        return evidence.log10_odds > acceptance.LEAST_ODDS
    if without.sse <= n:
        return False
    plain = evidence.log10_odds > acceptance.BEYOND_DOUBT_ODDS and evidence.share > acceptance.BEYOND_DOUBT_SHARE
    beyond_doubt = plain and (without.sse > acceptance.BEYOND_DOUBT_VARIANCE * n or own_shape)
    if math.sqrt(without.sse / n) - math.sqrt(with_it.sse / n) < practical_significance and not beyond_doubt:
        return False
    explained = 1.0 - max(without.sse - n, 0.0) / max(baseline.sse - n, 1e-9)
    much_left = explained < acceptance.MOSTLY_EXPLAINED or with_it.sse < acceptance.CLEAN * n
    wanted = acceptance.LEAST_SHARE if much_left else acceptance.SHARE_OF_THE_REST
    steady = evidence.steady > acceptance.STEADY_GAIN or evidence.share > acceptance.STEADY_SHARE
    if stands and evidence.beside_discrepancy > acceptance.BESIDE_DISCREPANCY and steady:
        return True
    return evidence.log10_odds > acceptance.LEAST_ODDS and evidence.share > wanted and steady


def could_any_be_accepted(without: Fit, practical_significance: float) -> bool:
    """Return whether any candidate at all could be worth a fit: what is white from row to row no law of the machine explains.

    Args:
        without: The fit that it would be added to.
        practical_significance: As in `is_accepted`.
    """
    level = math.sqrt(without.sse / max(without.residual.size, 1))
    if level**2 > acceptance.BEYOND_DOUBT_VARIANCE:
        return True
    return level - acceptance.STAYS_WHITE * white_noise(without.residual) >= practical_significance


def could_be_accepted(promised: float, without: Fit, practical_significance: float) -> bool:
    """Return whether the linear signature of a candidate promises enough to be worth a full fit.

    Args:
        promised: By how much the sum of squares falls if the response is proportional.
        without: The fit that it would be added to.
        practical_significance: As in `is_accepted`.
    """
    n = max(without.residual.size, 1)
    missing = max(without.sse - n, 0.0)
    seen = without.sse - n * max(math.sqrt(without.sse / n) - practical_significance, 0.0) ** 2
    beyond_doubt = max(acceptance.BEYOND_DOUBT_SHARE * missing, 2.0 * math.log(10.0) * acceptance.BEYOND_DOUBT_ODDS)
    return acceptance.UNDERRATED * promised >= max(min(seen, beyond_doubt), acceptance.LEAST_SHARE * missing)
