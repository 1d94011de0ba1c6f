"""What a recording of a motion is large in."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import motion_runs
from diagnosis.motion_runs import POSITION, VELOCITY

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.scales import MotionScales


def test_they_are_those_of_the_motion_and_of_what_is_missing() -> None:
    model = MotionModel([motion_runs.balance(30.0 * VELOCITY, 0.3)], motion_runs.plant(), Split({}))
    found = MotionScales.of(model)
    assert found.travel == pytest.approx(float(np.std(POSITION)))
    assert 0.0 < found.slowest < found.fastest <= float(np.abs(VELOCITY).max())
    assert found.level == pytest.approx(0.5 * float(np.std(30.0 * VELOCITY)), rel=0.1)
    assert found.size == pytest.approx(2.0 * found.level / model.noise, rel=0.01)


def test_a_rig_that_knows_its_friction_gives_the_level() -> None:
    plant = motion_runs.plant()
    plant.cylinder["coulomb_friction"]["force"] = 120.0
    model = MotionModel([motion_runs.balance(np.zeros(VELOCITY.size), 0.3)], plant, Split({}))
    assert MotionScales.of(model).level == 120.0
