"""The plug-in on machines: forces of others on a joint, friction of joints, several cylinders on one supply."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from simulation.started import start

from exo_sim.machine.rig_model import load
from exo_sim.rig import parse
from exo_sim.simulation.plugin import PneumaticPlugin


def test_forces_of_others_on_a_joint_with_friction_stay(bench: Path) -> None:
    _, data, plugin = start(bench, '\n[effects.viscous_friction.slide]\ncoefficient = "50 N s/m"\n')
    data.qfrc_applied[0] = 7.0
    data.qvel[0] = 0.2
    for _ in range(50):
        plugin.step(data)
    felt = plugin.plant.felt[0]
    assert data.qfrc_applied[0] == pytest.approx(7.0 + felt, abs=1e-9)
    assert felt != 0.0
    data.qfrc_applied[0] += 3.0
    plugin.step(data)
    assert data.qfrc_applied[0] == pytest.approx(10.0 + plugin.plant.felt[0], abs=1e-9)


def test_joint_friction_is_the_friction_of_its_joint(bench: Path) -> None:
    _, data, plugin = start(bench, '\n[effects.coulomb_friction.slide]\nforce = "30 N"\n')
    data.qvel[0] = 0.3
    plugin.pneumatics.cylinders["vented"] = 1.0
    plugin.pneumatics.cylinders["valve_area"] = 1e-3
    plugin.reset(data)
    for _ in range(400):
        plugin.step(data)
    assert data.qvel[0] == pytest.approx(0.0, abs=1e-6)
    assert data.qpos[0] - 0.08 == pytest.approx(10.0 * 0.3**2 / (2 * 30.0), rel=0.05)


LEG = """
<mujoco model="bench">
  <option timestep="0.001"/>
  <worldbody>
    <site name="hip_base" pos="-0.12 0 0.1"/>
    <body>
      <joint name="hip" type="hinge" axis="0 1 0" damping="0.2" range="-40 40" limited="true"/>
      <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" mass="5"/>
      <site name="hip_end" pos="-0.05 0 -0.2"/>
      <site name="knee_base" pos="0.05 0 -0.1"/>
      <body pos="0 0 -0.4">
        <joint name="knee" type="hinge" axis="0 1 0" damping="0.2" range="0 80" limited="true"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" mass="3"/>
        <site name="knee_end" pos="0.06 0 -0.05"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <spatial name="hip"><site site="hip_base"/><site site="hip_end"/></spatial>
    <spatial name="knee"><site site="knee_base"/><site site="knee_end"/></spatial>
  </tendon>
  <actuator><motor name="hip" tendon="hip"/><motor name="knee" tendon="knee"/></actuator>
</mujoco>
"""


def test_two_cylinders_on_the_tendons_of_two_hinges(bench: Path, tmp_path: Path) -> None:
    (tmp_path / "bench.xml").write_text(LEG)
    text = bench.read_text()
    head, cylinder = text[: text.index("[cylinders")], text[text.index("[cylinders") :]
    for name, retracted in (("hip", "0.2 m"), ("knee", "0.25 m")):
        own = cylinder.replace("cylinders.piston", f"cylinders.{name}").replace('"piston"', f'"{name}"')
        head += own.replace('retracted_length = "0 m"', f'retracted_length = "{retracted}"') + "\n"
    rig = parse(head, tmp_path / "bench.toml")
    model = load(rig)
    data = mujoco.MjData(model)
    data.qpos[1] = 0.4
    plugin = PneumaticPlugin(model, rig)
    assert [link.joint for link in plugin.links] == ["hip", "knee"]
    plugin.reset(data, 3e5, 3e5)
    assert plugin.lengths == pytest.approx(data.actuator_length - [0.2, 0.25])
    for _ in range(1000):
        plugin.command[:] = 0.2 * np.sin(2 * np.pi * data.time), 0.2 * np.cos(2 * np.pi * data.time)
        plugin.step(data)
    assert plugin.books().mass_residual < 1e-10
    assert (plugin.books().drawn > 1e-5).all()
    assert data.ctrl == pytest.approx(plugin.force)


def test_one_cylinders_stroke_is_felt_by_another_on_the_same_supply_and_exhaust(bench: Path, tmp_path: Path) -> None:
    (tmp_path / "bench.xml").write_text(LEG)
    text = bench.read_text()
    head, cylinder = text[: text.index("[cylinders")], text[text.index("[cylinders") :]
    for name, retracted in (("hip", "0.2 m"), ("knee", "0.25 m")):
        own = cylinder.replace("cylinders.piston", f"cylinders.{name}").replace('"piston"', f'"{name}"')
        head += own.replace('retracted_length = "0 m"', f'retracted_length = "{retracted}"') + "\n"
    shared = '[effects.supply_droop.supply]\nvolume = "0.5 L"\nconductance = "1e-8 kg/(s Pa)"\n'
    shared += '[effects.exhaust_back_pressure.exhaust]\narea = "2 mm^2"\n'
    seen = {}
    for extra in ("", shared):
        rig = parse(head + extra, tmp_path / "bench.toml")
        model = load(rig)
        for busy in (0.0, 0.8):
            data = mujoco.MjData(model)
            data.qpos[1] = 0.4
            plugin = PneumaticPlugin(model, rig)
            plugin.reset(data, 3e5, 3e5)
            gas, still = plugin.pneumatics, plugin.lengths.copy()
            for i in range(300):  # rods locked: only the gas can carry news
                gas.advance(still, still, np.array([busy * (1.0 if i % 100 < 50 else -1.0), 0.3]))
            seen[extra, busy] = gas.pressures(still)[1]
            assert plugin.books().mass_residual < 1e-10
    assert seen["", 0.0] == pytest.approx(seen["", 0.8], rel=1e-6)  # stages of a step are shared, and so is their small error
    assert np.abs(seen[shared, 0.0] - seen[shared, 0.8]).max() > 1e3
