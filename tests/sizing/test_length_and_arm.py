"""The closed-form linkage, against MuJoCo's."""

import mujoco
import numpy as np
import pytest

from exo_sim.machine.linkage import moment_row
from exo_sim.machine.rig_model import load
from exo_sim.sizing.length_and_arm import length_and_arm


def test_closed_form_linkage_is_mujocos(exo, space):
    model = load(exo)
    data = mujoco.MjData(model)
    for kind in space.kinds:
        for angle in np.linspace(kind.range[0], kind.range[1], 7):
            data.joint(kind.joints[1]).qpos[0] = angle
            mujoco.mj_forward(model, data)
            index = model.actuator(kind.cylinders[1]).id
            length, arm = length_and_arm(kind.own, kind.across, np.array([angle]))
            assert length[0] == pytest.approx(data.actuator_length[index], rel=1e-12)
            dof = int(model.joint(kind.joints[1]).dofadr[0])
            assert arm[0] == pytest.approx(moment_row(model, data, index)[dof], rel=1e-9)
