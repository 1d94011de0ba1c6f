"""What an effect gains on held-out time, in all and block by block."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.correlation import Blocked
from exo_sim.diagnosis.policy import validation
from exo_sim.diagnosis.selection.evidence import misfit

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HeldOutGain:
    """What a finding gains on held-out time.

    Attributes:
        gained: By how much the sum of squared errors falls with it, in units of the noise.
        missing: By how much that sum exceeds the noise without it.
        is_plain: Whether that is more than noise does by chance.
        amplitude, error: How much of the change that it makes to predictions is there, by least squares, and the standard error of that:
            1 where the recording shows it as it was found, 0 where not at all.
        log10_odds: By how much that changes the odds that it is there, all of it against none, by Student's distribution over blocks of
            time; 0 where one block shows all of the change, and says nothing of its own error.
    """

    gained: float
    missing: float
    is_plain: bool = True
    amplitude: float = 0.0
    error: float = 0.0
    log10_odds: float = 0.0

    @property
    def tells(self) -> bool:
        """Whether it says anything of the change: not of one in a single block of time."""
        return self.log10_odds != 0.0

    @property
    def is_absent(self) -> bool:
        """Whether the change that it makes is surely not there; held-out time may tell it neither from nothing nor from all of it."""
        reach = validation.TOLD_APART * self.error
        undecided = abs(self.amplitude) < reach and abs(self.amplitude - 1.0) < reach
        return not undecided and self.amplitude + self.error <= validation.SHOWN

    @property
    def speaks_against(self) -> bool:
        """Whether a small share speaks against it: where more than noise is missing, and the change that it makes is surely not there.

        Beside something larger that is missing as well a true effect explains little.
        """
        return self.is_plain and self.is_absent

    @property
    def is_shown(self) -> bool:
        """Whether its change is surely there, more of it than not."""
        return self.amplitude > max(validation.TOLD_APART * self.error, validation.SHOWN)

    @property
    def share(self) -> float:
        """What it explains of the squared error that is missing beyond the noise without it, 0 to 1."""
        share = self.gained / max(self.missing, self.gained, 1e-12)
        return min(max(share, 0.0), 1.0) if math.isfinite(share) else 0.0


def gain_in_errors(rows: Blocked, without: Array, with_it: Array) -> float:
    """Return by how many standard errors the mean gain of a block of time exceeds nil; minus infinity for fewer than two blocks.

    The gain of a block is that in the log-likelihood of a row whose level of error is unknown: beside something that has no name the
    errors of one block may be many times those of another, and the loudest must not decide alone, neither for an effect nor against it.

    Args:
        rows: Whose rows they are.
        without, with_it: Whitened residuals of two models, shape (n,).
    """
    count = np.bincount(rows.blocks)
    there = count > 0
    levels = [np.bincount(rows.blocks, weights=one**2)[there] / count[there] for one in (without, with_it)]
    gains = np.array([0.5 * (misfit(a) - misfit(b)) for a, b in zip(*levels, strict=True)])
    if gains.size < 2 or not np.isfinite(gains).all():
        return -math.inf
    error = float(gains.std(ddof=1)) / math.sqrt(gains.size)
    mean = float(gains.mean())
    return mean / error if error > 0.0 else math.copysign(math.inf, mean) if mean else 0.0
