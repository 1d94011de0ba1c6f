"""The record of a machine and its recordings: who drives which joint, tables by name, and stages that leave it alone."""

from __future__ import annotations

from dataclasses import FrozenInstanceError
from pathlib import Path

import benches
import pytest

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load


def test_joints_and_tables_are_found_by_name_and_nothing_is_written_into_it(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path)
    model, table = load(rig), benches.led(rig, 0.1)
    data = MachineData(rig, model, linkages(rig, model), (table,), (table,), {}, {})
    assert data.joint_of("piston") == "slide"
    assert data.table("bench") is table
    with pytest.raises(FrozenInstanceError):
        data.remarks = ("written",)  # type: ignore[misc]
