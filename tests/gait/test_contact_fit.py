"""The sway of the pelvis about its steady advance, as the fit of a stride takes it."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.gait.contact_fit import PATH_HARMONICS, PHASES, sway_of

PHASE = np.arange(PHASES) / PHASES


@pytest.mark.parametrize("advance", [0.0, 1.4])
def test_a_sway_of_known_harmonics_is_given_back(advance: float) -> None:
    sizes = (0.012, -0.004, 0.003, 0.006)
    path = 0.2 + advance * PHASE
    for i, harmonic in enumerate(PATH_HARMONICS):
        turn = 2.0 * np.pi * harmonic * PHASE
        path = path + sizes[2 * i] * np.cos(turn) + sizes[2 * i + 1] * np.sin(turn)
    np.testing.assert_allclose(sway_of(path), sizes, atol=1e-4)


def test_a_steady_advance_has_none() -> None:
    np.testing.assert_allclose(sway_of(1.3 * PHASE), 0.0, atol=1e-12)
