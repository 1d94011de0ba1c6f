"""What a driven ankle's motor must give: torque within the rig's limit, and the power that comes of it."""

from dataclasses import replace

import numpy as np
import pytest

from exo_sim.rig import Ankle
from exo_sim.sizing.ankle_motor import ankle_motor
from exo_sim.sizing.loads import JOINTS, Condition, JointLoads

TURN = np.linspace(0.0, 2 * np.pi, 1000, endpoint=False)


def waves(condition: Condition, amplitude: float, speed: float, late: float) -> JointLoads:
    """Torque a sin, speed v sin later by `late`, at the left ankle; half of it at the right."""
    torque, rate = np.zeros((len(TURN), 6)), np.zeros((len(TURN), 6))
    for joint, share in (("ankle_l", 1.0), ("ankle_r", 0.5)):
        torque[:, JOINTS.index(joint)] = share * amplitude * np.sin(TURN)
        rate[:, JOINTS.index(joint)] = share * speed * np.sin(TURN - late)
    return JointLoads(condition, 2.0, np.zeros_like(rate), rate, torque, None, None, 50.0)


def test_of_a_known_motion(exo, condition):
    rig = replace(exo, ankle=Ankle("powered", 0.0, 80.0))
    one = ankle_motor(rig, (waves(condition, 40.0, 3.0, 0.0), waves(condition, 20.0, 4.0, np.pi)))
    assert one is not None and one.joint == "ankle_l"
    assert one.torque == one.asked == pytest.approx(40.0, rel=1e-4)
    assert one.rms == pytest.approx(40.0 / np.sqrt(2.0)) and one.speed == pytest.approx(4.0, rel=1e-4)
    assert one.power == pytest.approx(120.0, rel=1e-4)
    assert one.given == pytest.approx(60.0) and one.taken == pytest.approx(40.0)  # each of its own condition
    assert one.needed == pytest.approx(0.5)
    assert "limit of the rig" not in one.words


def test_the_rigs_limit_cuts_it(exo, condition):
    rig = replace(exo, ankle=Ankle("powered", 0.0, 10.0))
    one = ankle_motor(rig, (waves(condition, 40.0, 3.0, 0.0),))
    assert one is not None and one.torque == 10.0 and one.asked == pytest.approx(40.0, rel=1e-4)
    assert one.power == pytest.approx(30.0, rel=1e-4) and one.taken == pytest.approx(0.0)
    assert "10 N m (limit of the rig; 40 would carry everything)" in one.words


@pytest.mark.parametrize("mode", ["sprung", "free"])
def test_none_where_no_motor_is(exo, condition, mode):
    assert ankle_motor(replace(exo, ankle=Ankle(mode)), (waves(condition, 40.0, 3.0, 0.0),)) is None
