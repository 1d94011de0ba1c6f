"""What a controller may return, and what is said of the rest."""


import numpy as np
import pytest

from exo_sim.control import user_controller
from exo_sim.errors import ScenarioError


def test_commands_by_name_or_in_the_order_of_the_cylinders(context):
    assert context.cylinders == ("hip_l", "knee_l", "hip_r", "knee_r")
    for returned in ({"knee_l": 0.5, "hip_r": -1}, {"knee_l.valve_command": 0.5, "hip_r": -1.0}, [0.0, 0.5, -1.0, 0.0]):
        found = user_controller.read(returned, context)
        assert found.kind == user_controller.VALVES
        np.testing.assert_array_equal(found.values, [0.0, 0.5, -1.0, 0.0])
    found = user_controller.read({"knee_r.torque": 20.0, "ankle_l": 3.0}, context)
    assert found.kind == user_controller.TORQUES
    np.testing.assert_array_equal(found.values, [0.0, 0.0, 3.0, 0.0, 20.0, 0.0])
    assert user_controller.read({}, context, user_controller.TORQUES).kind == user_controller.TORQUES


@pytest.mark.parametrize(
    ("returned", "hint"),
    [
        (None, "returned nothing"),
        ({"kne_l": 0.5}, 'did you mean "knee_l"'),
        ({"knee_l.torque": 5.0, "hip_l": 0.5}, "one kind"),
        ({"knee_l": "much"}, "not a number"),
        ({"knee_l": float("nan")}, "nan"),
        ([0.1, 0.2], "2 numbers"),
        (object(), "returned a object"),
    ],
)
def test_what_is_no_command_is_said(context, returned, hint):
    with pytest.raises(ScenarioError, match=hint):
        user_controller.read(returned, context)
