"""Feet that leave the ground later: they strike when they did, stay where they stand, and share the load."""

import numpy as np
import pytest

from exo_sim.gait import scenario
from exo_sim.gait.foot_timing import leaving_later
from exo_sim.gait.footpaths import paths
from exo_sim.gait.motion import SAMPLES
from exo_sim.machine.person import Person

PERSON = Person()


@pytest.mark.parametrize("later", [-0.03, 0.02])
def test_a_foot_leaves_later_and_strikes_when_and_where_it_did(later: float) -> None:
    level = scenario.motion("level_walk", PERSON, 1.0)
    before = paths(level, PERSON)
    after, like = leaving_later(before, level, later)
    for name in ("ahead", "up", "pitch", "roll"):
        assert getattr(after, name)[0, 1] == pytest.approx(getattr(before, name)[0, 1], abs=1e-9)
    assert np.mean(like.share > 0.0) == pytest.approx(np.mean(level.share > 0.0) + later, abs=2.5 / SAMPLES)
    np.testing.assert_allclose(like.share.sum(axis=1), 1.0)
    flat = slice(round(0.15 * SAMPLES), round(0.4 * SAMPLES))
    assert np.ptp(after.ahead[flat, 1]) < np.ptp(before.ahead[flat, 1]) + 1e-3  # where it stands it stays
    np.testing.assert_allclose(after.ahead[: SAMPLES // 2, 0] + 0.5 * level.advance, after.ahead[SAMPLES // 2 :, 1], atol=1e-6)
    np.testing.assert_array_equal(after.pelvis, before.pelvis)


def test_nothing_changes_where_nothing_is_asked() -> None:
    level = scenario.motion("level_walk", PERSON, 1.0)
    before = paths(level, PERSON)
    assert leaving_later(before, level, 0.0) == (before, level)
