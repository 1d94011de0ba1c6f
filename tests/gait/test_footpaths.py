"""A walk as paths of pelvis and feet, and back; what raises and lowers the pelvis."""

import numpy as np
import pytest

from exo_sim.gait import scenario
from exo_sim.gait.footpaths import paths, reach, walked, within_reach
from exo_sim.machine.ground import LEVEL
from exo_sim.machine.person import Person


@pytest.mark.parametrize("height", [1.55, 1.70])
def test_paths_lead_back_to_the_same_angles(height):
    person = Person(height)
    motion = scenario.motion("level_walk", person, 1.0)
    again = walked(paths(motion, person), motion, person, LEVEL, motion.advance, motion.period)
    np.testing.assert_allclose(again.position, motion.position, atol=1e-9)
    np.testing.assert_allclose(again.slope, motion.slope, atol=1e-6)


def test_the_pelvis_is_as_high_as_the_legs_allow():
    person = Person()
    it = paths(scenario.motion("level_walk", person, 1.0), person)
    far = reach(it, person, LEVEL)
    same = within_reach(it, person, LEVEL, far, 0.0)
    np.testing.assert_allclose(same.pelvis, it.pelvis, atol=1e-9)
    shorter = within_reach(it, person, LEVEL, far - 0.02, 0.0)
    assert reach(shorter, person, LEVEL) == pytest.approx(far - 0.02, abs=1e-6)
    bobbing = within_reach(it, person, LEVEL, far - 0.02, 0.01)
    assert reach(bobbing, person, LEVEL) < far - 0.02 + 1e-6
    assert bobbing.pelvis[:, 1].mean() > shorter.pelvis[:, 1].mean() + 0.002
