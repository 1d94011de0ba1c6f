"""The pendulum's swings: six of them, at the rate of the rig."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from recording.faultless import quiet

from exo_sim.recording.foreign.pendulum import read_pendulum


@pytest.mark.real_data
def test_the_pendulum_swings_at_the_rate_of_its_rig(shared_data: Path, repository: Path) -> None:
    swings = read_pendulum(shared_data / "pendulum" / "SinglePendulumDataForParameterEstimation.mat")
    assert list(swings) == [f"identify_{i}" for i in range(1, 5)] + ["validate_1", "validate_2"]
    for swing in swings.values():
        quiet(swing)
        slope = np.gradient(swing["arm.position"], swing.time)
        assert np.std(slope - swing["arm.velocity"]) < 0.02 * np.std(slope)
    model = mujoco.MjModel.from_xml_path(str(repository / "assets" / "real" / "pendulum" / "pendulum.xml"))
    data = mujoco.MjData(model)
    last = swings["validate_2"]
    start = slice(0, 800)  # one swing: friction has not yet changed its rate
    data.qpos[0], data.qvel[0] = last["arm.position"][0], last["arm.velocity"][0]
    simulated = []
    for _ in range(800):
        simulated.append(data.qpos[0])
        mujoco.mj_step(model, data)
    assert np.std(np.array(simulated) - last["arm.position"][start]) < 0.05
