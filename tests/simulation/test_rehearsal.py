"""What a rehearsal shows of the machine's heels and toes."""

from types import SimpleNamespace
from typing import Any, cast

import mujoco
import numpy as np

from exo_sim.simulation.rehearsal import carrying
from exo_sim.simulation.walk import Walk

FEET = """<mujoco><worldbody>{}</worldbody></mujoco>"""
FOOT = """<body name="foot_{0}"><geom name="heel_{0}" size="0.02" pos="-0.05 0 0"/><geom name="toe_{0}" size="0.02" pos="0.15 0 0"/>
<site name="foot_{0}" pos="0.05 0 0"/></body>"""


def test_heel_and_toe_carry_by_where_the_ground_pushes() -> None:
    model = mujoco.MjModel.from_xml_string(FEET.format(FOOT.format("l") + FOOT.format("r")))
    columns = {
        "foot_l.ground_force_z": np.array([200.0, 200.0, 200.0, 30.0]), "foot_l.pressure_centre": np.array([-0.1, 0.0, 0.1, 0.0]),
        "foot_r.ground_force_z": np.array([0.0, 200.0, 200.0, 60.0]), "foot_r.pressure_centre": np.array([0.0, 0.12, 0.09, 0.05]),
    }  # fmt: skip
    walk = cast(Walk, cast(Any, SimpleNamespace(model=model, columns=columns)))
    np.testing.assert_array_equal(carrying(walk), [[1, 0, 0, 0], [1, 1, 0, 1], [0, 1, 0, 1], [0, 0, 0, 1]])
