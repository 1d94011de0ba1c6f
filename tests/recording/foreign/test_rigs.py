"""The rigs of real machines that come along open, without effects, damping or friction of their own."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

from exo_sim import rig

MACHINES = ("emps", "pendulum", "gas_spring", "seals_friction", "pressure_decay")


@pytest.mark.parametrize("machine", MACHINES)
def test_believed_rigs_open(repository: Path, machine: str) -> None:
    believed = rig.read(repository / "assets" / "real" / machine / "rig.toml")
    model = mujoco.MjModel.from_xml_path(str(believed.model))
    assert believed.name == machine
    assert not believed.effects
    assert (model.dof_damping == 0.0).all() and (model.dof_frictionloss == 0.0).all()
