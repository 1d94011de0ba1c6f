"""What cylinders hold along a motion, by the area, the pressure and the arm."""

import mujoco
import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.control import machine_dynamics
from exo_sim.machine.linkage import moment_row
from exo_sim.simulation.torque_limits import too_weak, torque_limits
from exo_sim.simulation.walk import Request, rig_at_250_psi
from exo_sim.simulation.worn import Simulation


@pytest.fixture(scope="module")
def vented():
    return Simulation(rigs.read(rig_at_250_psi()), Request("stand", cycles=1, assist="vented"))


def test_the_limits_are_the_largest_forces_times_the_arm(vented):
    limits = torque_limits(vented.plugin, vented.motion)
    assert limits.shape == (machine_dynamics.PHASES, 6, 2)
    rig, link = vented.rig, vented.plugin.links[0]
    cylinder = rig.cylinders[link.cylinder]
    gauge = rig.supply.pressure - rig.environment.pressure
    data = mujoco.MjData(vented.model)
    data.qpos[:] = vented.motion.position[machine_dynamics.PICK][0]
    mujoco.mj_forward(vented.model, data)
    arm = moment_row(vented.model, data, link.actuator)[link.dof]
    assert limits[0, link.dof - 3] == pytest.approx(np.sort([gauge * cylinder.area_1 * arm, -gauge * cylinder.area_2 * arm]), rel=1e-9)


def test_a_cylinder_that_is_too_weak_is_named_with_what_it_holds(vented):
    limits = torque_limits(vented.plugin, vented.motion)
    links = vented.plugin.links
    enough = 0.5 * limits.sum(axis=-1)
    assert too_weak(links, 20.0, enough, limits) == ()
    joint = links[1].dof - 3
    more = enough.copy()
    more[7, joint] = limits[7, joint, 1] + 5.0
    (remark,) = too_weak(links, 20.0, more, limits)
    assert remark.startswith("20 kg is more than the cylinders carry: ")
    assert f"{links[1].cylinder} holds {limits[7, joint, 1]:.0f} of {more[7, joint]:.0f} N m" in remark
