"""Coefficients of the Chebyshev method: order two, stability up to its reach and no further."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.physics.runge_kutta_chebyshev import MOST_STAGES, REACH, coefficients, enough_stages, stable_reach


def gain(stages: int, reach: float) -> float:
    """Return by what one step of y' = -lambda y multiplies y, at h lambda = reach."""
    rows = coefficients(stages)
    y = [1.0, 1.0 - rows[1, 2] * reach]
    for j in range(2, stages + 1):
        mu, nu, mu_t, gamma_t, _ = rows[j]
        y.append(1.0 - mu - nu + mu * y[-1] + nu * y[-2] - mu_t * reach * y[-1] - gamma_t * reach)
    return float(y[-1])


@pytest.mark.parametrize("stages", [2, 3, 5, 9, MOST_STAGES])
def test_a_step_is_exp_to_second_order(stages: int) -> None:
    errors = [abs(gain(stages, h) - np.exp(-h)) for h in (0.02, 0.01)]
    assert errors[0] / errors[1] == pytest.approx(8.0, rel=0.1)


@pytest.mark.parametrize("stages", [2, 3, 5, 9, MOST_STAGES])
def test_modes_fade_up_to_the_reach_and_grow_beyond(stages: int) -> None:
    reach = stable_reach(stages)
    assert max(abs(gain(stages, h)) for h in np.linspace(0.05, 0.999, 60) * reach) < 1.0
    assert abs(gain(stages, 2.0 * reach)) > 1.0


def test_the_reach_grows_with_the_square_of_the_stages_and_enough_are_taken() -> None:
    assert REACH[20] / REACH[10] == pytest.approx(4.0, rel=0.15)
    for reach in (0.1, 5.0, 40.0):
        stages = enough_stages(reach)
        assert REACH[stages] >= reach and (stages == 2 or REACH[stages - 1] < reach)
    assert enough_stages(1e9) == MOST_STAGES
