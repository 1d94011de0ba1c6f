"""Where a joint lies against a stop."""

from __future__ import annotations

import mujoco
import numpy as np

from exo_sim.machine.joint_stops import AT_STOP_NOISE, touches_stop

MODEL = """
<mujoco><worldbody>
  <body><joint name="slide" type="slide" range="-0.1 0.2" limited="true" margin="0.01"/><geom size="0.1"/></body>
  <body><joint name="free" type="slide"/><geom size="0.1"/></body>
</worldbody></mujoco>
"""


def test_a_stop_is_felt_within_its_margin_and_what_the_position_may_be_off() -> None:
    model = mujoco.MjModel.from_xml_string(MODEL)
    position = np.array([-0.2, -0.091, -0.086, -0.084, 0.0, 0.184, 0.186, 0.3])
    assert touches_stop(model, 0, position, 0.0).tolist() == [True, True, False, False, False, False, False, True]
    assert touches_stop(model, 0, position, 0.005 / AT_STOP_NOISE).tolist() == [True, True, True, False, False, False, True, True]


def test_a_joint_without_stops_never_lies_against_one() -> None:
    model = mujoco.MjModel.from_xml_string(MODEL)
    assert not touches_stop(model, 1, np.linspace(-9.0, 9.0, 5), 1.0).any()
