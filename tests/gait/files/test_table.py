"""Joint angles in tables: the wearer's where a machine was worn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from exo_sim.errors import ScenarioError
from exo_sim.gait.files import table
from exo_sim.gait.walking_trial import JOINTS
from exo_sim.recording import Recording
from exo_sim.recording.table_file import write_table

TIME = np.arange(20) / 10
WEARER = {f"wearer_{name}.position": np.full(20, 0.1 * i) for i, name in enumerate((*JOINTS, "pitch", "x", "z"))}
MACHINE = {f"{name}.position": np.full(20, -1.0) for name in (*JOINTS, "torso_pitch")}
FORCES = {"ground_force_z": 1.0, "wearer_force_z": 700.0}
FEET = {f"foot_{side}.{force}": np.full(20, value) for side in "lr" for force, value in FORCES.items()}
UNITS = {key: "m" if key in ("wearer_x.position", "wearer_z.position") else "rad" for key in (*WEARER, *MACHINE)} | dict.fromkeys(FEET, "N")


def written(folder: Path, columns: dict[str, np.ndarray], **more: str) -> Path:
    units = {key: UNITS.get(key, more.get(key.split(".")[1], "")) for key in columns}
    write_table(folder / "walk.parquet", Recording("walk", TIME, columns, units, {}))
    return folder / "walk.parquet"


def test_who_wears_a_machine_is_read_and_not_the_machine(tmp_path: Path) -> None:
    trial, ground = table.read_angles(written(tmp_path, MACHINE | WEARER | FEET), {})
    assert [trial.angles[name][0] for name in JOINTS] == pytest.approx([0.1 * i for i in range(6)])
    assert [trial.angles[name][0] for name in ("tilt", "pelvis_x", "pelvis_z")] == pytest.approx([0.6, 0.7, 0.8])
    assert "walked is what its wearer did" in trial.remarks[0]
    assert ground is not None and {values[0] for values in ground.up.values()} == {700.0} and set(ground.foot.values()) == {"l", "r"}


def test_what_somebody_names_counts_before(tmp_path: Path) -> None:
    trial, _ = table.read_angles(written(tmp_path, MACHINE | WEARER), {"hip_l": "hip_l.position"})
    assert trial.angles["hip_l"][0] == -1.0 and trial.angles["knee_l"][0] == pytest.approx(0.1)


def test_a_machine_whose_wearer_is_known_by_moments_alone_is_refused(tmp_path: Path) -> None:
    moments = {"hip_l.wearer_total_moment": np.zeros(20)}
    path = written(tmp_path, MACHINE | moments, wearer_total_moment="N*m")
    with pytest.raises(ScenarioError, match=r"walk.parquet: its hip_l.position is the machine's, .* hand in the gait that he walked by"):
        table.read_angles(path, {})
    assert table.read_angles(path, {name: f"{name}.position" for name in JOINTS})[0].angles["hip_l"][0] == -1.0


def test_a_table_without_a_wearer_is_read_as_it_is(tmp_path: Path) -> None:
    trial, _ = table.read_angles(written(tmp_path, MACHINE), {})
    assert trial.angles["hip_l"][0] == -1.0 and not trial.remarks
