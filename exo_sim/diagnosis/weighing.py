"""How much better one model explains a recording than another, and whether that is enough to be a finding.

Errors of a model that misses something come in spells; what counts is how many spells there are, not how many samples.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.fitting import Fit

Array = NDArray[np.float64]

#: log10 of the odds that a finding must have against leaving it out.
LEAST_ODDS = 2.0
#: Share of the explainable error that a finding must explain.
LEAST_SHARE = 0.10
#: ... and where nine tenths are explained but the noise is not reached.
SHARE_OF_THE_REST = 0.5
#: A finding of such odds (log10) that takes more than this share of an error is one however small the error is, if it is above the
#: noise at all: residual variance in units of it.
GREAT_ODDS, LARGER_SHARE, ABOVE_NOISE = 50.0, 0.5, 1.2
#: By how many times a full fit may lower an error more than a signature, taken to be proportional, promised (of 68 that were accepted in
#: 15 opened cases: 2.8 times at most).
UNDERRATED = 10.0
#: Gain in log-likelihood a row that a healthy machine's imperfect model shows: the material floor.
HEALTHY_GAIN = 0.004
#: Residual variance in units of the noise that counts as nothing left.
CLEAN = 1.8
#: Lags at which the correlation of errors is looked at.
_LAGS = (1, 2, 3, 4, 5, 6, 8, 10, 13, 16, 20, 26, 32, 40, 52, 64, 80, 100, 128, 160, 200)


class Blocked(Protocol):
    """Rows in blocks of time."""

    blocks: NDArray[np.int64]

    @property
    def size(self) -> int: ...


@dataclass(frozen=True)
class Weighing:
    """How much better one model is than another.

    Attributes:
        log10_odds: Corrected for correlation, parameters and the size of the library.
        gain: Difference in log-likelihood, corrected for correlation.
        share: Part of the explainable error that it explains.
        steady: Mean gain over blocks in units of its standard error.
        material: Gain in log-likelihood a row, before the correction.
    """

    log10_odds: float
    gain: float
    share: float
    steady: float
    material: float


def correlation_time(residual: Array, blocks: NDArray[np.int64]) -> float:
    """Return how many neighbouring rows say the same, at least 1: the integrated autocorrelation inside blocks.

    Args:
        residual: Errors, shape (n,).
        blocks: Block of each, shape (n,); members of one are neighbours.
    """
    variance = float(residual @ residual) / max(residual.size, 1)
    if variance <= 0.0 or not math.isfinite(variance):
        return 1.0
    total, last, height = 1.0, 0, 1.0
    for lag in _LAGS:
        same = blocks[lag:] == blocks[:-lag]
        count = int(np.count_nonzero(same))
        if count < 20:
            break
        rho = float(np.sum(residual[lag:] * residual[:-lag] * same)) / count / variance
        # the trapezoid over the lags between, ends counted once
        total += (rho + height) * (lag - last) - (height - rho) if rho >= 0.05 else 0.0
        if rho < 0.05:
            break
        last, height = lag, rho
    return max(total, 1.0)


def misfit(variance: float) -> float:
    """Return twice the negative log-likelihood a row for a residual variance in units of the noise.

    Above the noise the level of the errors is unknown and its logarithm counts; below it the noise is known, and less is no gain.
    """
    return math.log(variance) if variance > 1.0 else variance - 1.0


def loss(fit: Fit, rows: float) -> float:
    """Return the negative log-likelihood of a fit whose errors say `rows` different things, the priors included."""
    return 0.5 * rows * misfit(fit.sse / max(fit.residual.size, 1)) + 0.5 * fit.penalty


def weigh(problem: Blocked, without: Fit, with_it: Fit, added: int, questions: int) -> Weighing:
    """Say how much better `with_it` explains the training time than `without`.

    Args:
        problem: Whose rows they are.
        without, with_it: The fits.
        added: By how many numbers the second is richer.
        questions: How many could have been asked.
    """
    n = problem.size
    a, b = without.sse, with_it.sse
    rows = n / correlation_time(with_it.residual, problem.blocks)
    gain = loss(without, rows) - loss(with_it, rows)
    odds = (gain - 0.5 * added * math.log(max(rows, 2.0))) / math.log(10.0) - math.log10(max(questions, 1))
    explainable = max(a - min(n, b), 1e-12)
    per_block = np.bincount(problem.blocks, weights=without.residual**2 - with_it.residual**2)
    gains = per_block[np.bincount(problem.blocks) > 0]
    error = float(gains.std(ddof=1)) / math.sqrt(gains.size) if gains.size > 1 else math.inf
    steady = float(gains.mean()) / error if error > 0.0 else math.inf
    material = 0.5 * (misfit(a / n) - misfit(b / n))
    return Weighing(odds, gain, max(a - b, 0.0) / explainable, steady, material)


def passes(weighing: Weighing, whole: Fit, without: Fit, with_it: Fit, material: float) -> bool:
    """Say whether a finding passes every gate.

    Once nine tenths are explained, a further effect must leave the noise, or take half of what is left: the last tenth of a real
    machine is shaped like nothing in particular, and everything fits a little of it.

    Args:
        weighing: What it gains.
        whole: The fit of the believed numbers alone.
        without, with_it: The fits that were weighed.
        material: Drop of the root-mean-square error, in units of the noise, below which a finding must be beyond doubt.
    """
    n = max(without.residual.size, 1)
    beyond_doubt = weighing.log10_odds > GREAT_ODDS and weighing.share > LARGER_SHARE and without.sse > ABOVE_NOISE * n
    if math.sqrt(without.sse / n) - math.sqrt(with_it.sse / n) < material and not beyond_doubt:
        return False
    explained = 1.0 - max(without.sse - n, 0.0) / max(whole.sse - n, 1e-9)
    wanted = LEAST_SHARE if explained < 0.9 or with_it.sse < CLEAN * n else SHARE_OF_THE_REST
    steady = weighing.steady > 2.0 or weighing.share > 0.2
    return weighing.log10_odds > LEAST_ODDS and weighing.share > wanted and steady and weighing.material > HEALTHY_GAIN


def promises(promised: float, without: Fit, material: float) -> bool:
    """Say whether what a signature promises could pass the gates: else the whole fit is not worth its time.

    Args:
        promised: By how much the sum of squares falls if the answer is proportional.
        without: The fit that it comes on top of.
        material: As in `passes`.
    """
    n = max(without.residual.size, 1)
    missing = max(without.sse - n, 0.0)
    seen = without.sse - n * max(math.sqrt(without.sse / n) - material, 0.0) ** 2
    wanted = min(seen, LARGER_SHARE * missing) if without.sse > ABOVE_NOISE * n else seen
    return UNDERRATED * promised >= max(wanted, LEAST_SHARE * missing)
