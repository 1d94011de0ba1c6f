"""The sway of the pelvis about its steady advance, as the fit of a stride takes it."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.gait import recorded_gait
from exo_sim.gait.contact_fit import PATH_HARMONICS, PHASES, fit, sway_of
from exo_sim.machine.person import Person

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


def test_a_recorded_sway_is_kept_and_the_foot_rests_all_the_same() -> None:
    gait, sway = recorded_gait.load("falisse"), np.array([-5.6e-3, 11.1e-3, -1.7e-3, 0.2e-3])
    spread = {name: series(PHASE) for name, series in gait.spread.items()}
    found = fit(gait.recorded, spread, sway, gait.stance_end, Person())
    path = found.series["pelvis_x"]
    np.testing.assert_array_equal([path.cosine[1], path.sine[1], path.cosine[3], path.sine[3]], sway)
    assert found.rest["heel_slide"] < 3e-3 and found.rest["toe_slide"] < 7e-3
    assert all(spreads < 1.7 for _, spreads in found.moved.values())
