from __future__ import annotations

import copy
from pathlib import Path

import mujoco
import numpy as np
import pytest

from exo_sim import rig
from exo_sim.simulation.plugin import PneumaticPlugin


@pytest.fixture(params=["bench", "exo"])
def machine(request: pytest.FixtureRequest, repository: Path) -> rig.Rig:
    return rig.read(repository / "assets" / f"{request.param}.toml")


def start(machine: rig.Rig) -> tuple[mujoco.MjModel, mujoco.MjData, PneumaticPlugin]:
    model = mujoco.MjModel.from_xml_path(str(machine.model))
    data, plugin = mujoco.MjData(model), PneumaticPlugin(model, machine)
    plugin.reset(data)
    return model, data, plugin


def ends_alike(a: tuple[mujoco.MjData, PneumaticPlugin], b: tuple[mujoco.MjData, PneumaticPlugin]) -> bool:
    return np.array_equal(a[0].qpos, b[0].qpos) and np.array_equal(a[1].pneumatics.vector, b[1].pneumatics.vector)


def test_the_short_form_of_a_step_is_the_long_one_to_the_last_bit(machine: rig.Rig) -> None:
    model, data, plugin = start(machine)
    _, other_data, other = start(machine)
    for i in range(60):
        plugin.command[:] = other.command[:] = 0.5 * np.sin(0.2 * i)
        plugin.step(data)
        mujoco.mj_step1(model, other_data)
        other.advance(other_data)
        other.compute(other_data)
        mujoco.mj_step2(model, other_data)
    assert ends_alike((data, plugin), (other_data, other))
    assert np.abs(data.ctrl).max() > 1.0


def test_copies_go_on_by_themselves(machine: rig.Rig) -> None:
    _, data, plugin = start(machine)
    plugin.command[:] = 0.3
    for _ in range(20):
        plugin.step(data)
    data_2, plugin_2 = copy.deepcopy((data, plugin))
    before = plugin.pneumatics.vector.copy()
    for _ in range(20):
        plugin_2.step(data_2)
    assert np.array_equal(plugin.pneumatics.vector, before)
    for _ in range(20):
        plugin.step(data)
    assert ends_alike((data, plugin), (data_2, plugin_2))


def test_commands_may_be_a_new_array_and_data_another(machine: rig.Rig) -> None:
    model, data, plugin = start(machine)
    _, other_data, other = start(machine)
    plugin.step(data)
    other.step(other_data)
    snapshot = plugin.snapshot(data)
    plugin.command = np.full(len(plugin.command), 0.4)
    other.command[:] = 0.4
    elsewhere = mujoco.MjData(model)
    plugin.restore(elsewhere, snapshot)
    for _ in range(20):
        plugin.step(elsewhere)
        other.step(other_data)
    assert ends_alike((elsewhere, plugin), (other_data, other))
