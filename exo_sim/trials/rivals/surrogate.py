"""The rival that knows no physics beyond the paper's: a Gaussian process over the measured signals for what the balances leave over."""

from __future__ import annotations

import warnings

import numpy as np

from exo_sim.trials.rivals.selection import held_out
from exo_sim.trials.rivals.weak_form import Regression

#: Windows that the process is conditioned on; its cost grows with their cube.
MOST_WINDOWS = 400
#: A share of the held-out error that is gained by chance on machines without anything hidden.
NOTHING = 0.1


def explained(regression: Regression) -> float:
    """Return by what share the held-out error falls when what is left over is predicted from the signals.

    A squared-exponential kernel with a length scale for each signal, and white noise; by scikit-learn, numbers of the kernel by marginal
    likelihood (Rasmussen and Williams 2006, equation 5.8).
    """
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    inputs, rest = regression.inputs, regression.rest
    spread = inputs.std(axis=0)
    used = spread > 0.0
    size = float(rest.std())
    if not used.any() or size == 0.0:
        return 0.0
    inputs, rest = (inputs[:, used] - inputs[:, used].mean(axis=0)) / spread[used], rest / size
    odd = held_out(len(rest))
    known = np.flatnonzero(~odd)
    known = known[:: max(len(known) // MOST_WINDOWS, 1)]
    kernel = ConstantKernel(1.0) * RBF(np.full(inputs.shape[1], 2.0), (0.1, 1e3)) + WhiteKernel(0.5, (1e-4, 10.0))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # a signal that says nothing has a length scale at its bound
        process = GaussianProcessRegressor(kernel, random_state=0).fit(inputs[known], rest[known])
    left = rest[odd] - process.predict(inputs[odd])
    return 1.0 - float(np.sqrt(np.mean(left**2)) / np.sqrt(np.mean(rest[odd] ** 2)))
