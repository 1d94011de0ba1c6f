"""Errors of a pressure that are too fast for the rows of its fit: something rings, and no slow effect can be it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.fitted_set import Trial
from exo_sim.diagnosis.gas_problem import GasProblem

Array = NDArray[np.float64]

#: A stretch over which the level of what is fast is taken, in samples.
STRETCH = 50
#: The livelier stretches are these [%], held against the middle one: a sensor's own noise is as loud everywhere.
LIVELY = 95.0
#: Of 208 healthy benches two came above 1.2 (1.32 and 1.41), with quiet sensors; hoses that ring at ten limits left 2.8 to 5.3.
TREMBLING = 1.6


def trembles(problem: GasProblem, trial: Trial) -> bool:
    """Say whether what is fast in a pressure's error comes in bursts, louder than what its sensor does at other times."""
    setting = problem.apply(trial.fit.values, trial.fixed)
    return any(tremor(fast, noise) > TREMBLING for fast, noise in problem.fast_errors(setting))


def tremor(fast: Array, noise: float) -> float:
    """Return how much louder the livelier stretches are than the middle one, or than the sensor's noise where that is more.

    Args:
        fast: Errors less the mean of their group, shape (n,).
        noise: Standard deviation of the sensor's white noise.
    """
    count = len(fast) // STRETCH
    if count < 2:
        return 0.0
    level = np.sqrt(np.mean(fast[: count * STRETCH].reshape(count, STRETCH) ** 2, axis=1))
    return float(np.percentile(level, LIVELY) / max(noise, float(np.median(level)), 1e-12))
