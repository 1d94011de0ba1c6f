"""Rigs whose joints' drives give or play: the compiled walk and the step-by-step plug-in are one simulation."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from exo_sim import rig
from exo_sim.physics.plant import gives
from exo_sim.simulation import loop
from exo_sim.simulation.loop_wiring import wire
from exo_sim.simulation.plugin import PneumaticPlugin
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation

EFFECTS = {
    "backlash": '[effects.backlash.knee_r]\ngap = "1.0 deg"',
    "compliance": '[effects.transmission_compliance.hip_l]\nstiffness = "2000 N*m/rad"',
    "spring and friction": '[effects.return_spring.knee_l]\nstiffness = "20 N*m/rad"\nrest = "30 deg"\n'
    '[effects.coulomb_friction.hip_r]\ntorque = "2 N*m"',
}


@pytest.fixture(params=list(EFFECTS.values()), ids=list(EFFECTS))
def machine(request: pytest.FixtureRequest, repository: Path, tmp_path: Path) -> rig.Rig:
    text = (repository / "assets" / "exo_250_psi.toml").read_text()
    text = text.replace('"exo.xml"', f'"{(repository / "assets" / "exo.xml").as_posix()}"')
    text = text.replace("[cylinders.", "[cylinders.drive_")  # an effect at a name that both have is the cylinder's
    path = tmp_path / "exo.toml"
    path.write_text(f"{text}\n{request.param}\n")
    return rig.read(path)


def test_the_walk_is_the_plugin_step_by_step(machine: rig.Rig) -> None:
    request = Request("level_walk", 20.0, cycles=1, law="inverse_dynamics")
    walk, other = Simulation(machine, request), Simulation(machine, request)
    wired = wire(walk)
    row = np.empty((1, 20000))
    model, data, plugin = other.model, other.data, other.plugin
    for i in range(400):
        loop.run(i, 1, *wired, row)
        mujoco.mj_step1(model, data)
        plugin.advance(data)
        for name in ("xfrc_applied", "mocap_pos", "mocap_quat"):
            getattr(data, name)[:] = getattr(walk.data, name)
        plugin.command[:] = walk.plugin.command
        plugin.compute(data)
        mujoco.mj_step2(model, data)
    assert np.array_equal(data.qpos, walk.data.qpos)
    assert np.array_equal(plugin.pneumatics.vector, walk.plugin.pneumatics.vector)
    assert np.abs(walk.plugin.command).max() > 0.0


def test_the_short_form_of_a_step_follows_the_moment_arm(machine: rig.Rig) -> None:
    model = mujoco.MjModel.from_xml_path(str(machine.model))
    data, other_data = mujoco.MjData(model), mujoco.MjData(model)
    plugin, other = PneumaticPlugin(model, machine), PneumaticPlugin(model, machine)
    plugin.reset(data)
    other.reset(other_data)
    start = plugin.pneumatics.cylinders["arm"].copy()
    for i in range(200):
        plugin.command[:] = other.command[:] = 0.3 * np.sin(0.05 * i)
        plugin.step(data)
        mujoco.mj_step1(model, other_data)
        other.advance(other_data)
        other.compute(other_data)
        mujoco.mj_step2(model, other_data)
    assert np.array_equal(data.qpos, other_data.qpos)
    assert np.array_equal(plugin.pneumatics.vector, other.pneumatics.vector)
    if any(gives(c) for c in plugin.pneumatics.cylinders):
        assert np.ptp([start, plugin.pneumatics.cylinders["arm"]], axis=0).max() > 1e-3
