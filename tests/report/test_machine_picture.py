from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from matplotlib.image import imread

from exo_sim import rig
from exo_sim.machine.person import Person
from exo_sim.machine.worn_model import build
from exo_sim.report import machine_picture


@pytest.fixture(scope="module")
def machine(repository: Path) -> rig.Rig:
    return rig.read(repository / "assets" / "exo_250_psi.toml")


@pytest.fixture(scope="module")
def model(machine: rig.Rig) -> mujoco.MjModel:
    return build(machine.model, Person(), 34.0, machine.ankle)


@pytest.fixture
def columns(model: mujoco.MjModel) -> dict[str, np.ndarray]:
    time = np.linspace(0.0, 3.0, 301)
    joints = {f"{model.joint(i).name}.position": np.zeros(301) for i in range(model.njnt)}
    joints["torso_z.position"] += 0.879
    joints["hip_l.position"] = 0.5 * np.sin(2 * np.pi * time)
    forces = {f"foot_{side}.ground_force_z": np.full(301, 300.0) for side in "lr"}
    return {**joints, **forces, "gait.phase": time % 1.0}


def test_a_stride_is_the_last_whole_cycle(columns: dict[str, np.ndarray]) -> None:
    assert machine_picture.stride(columns, 4) == [200, 225, 250, 275]
    assert machine_picture.stride({"slide.position": np.zeros(8)}, 4) == [0, 1, 3, 5]


def drawn(model: mujoco.MjModel, machine: rig.Rig, columns: dict[str, np.ndarray], rows: list[int]) -> np.ndarray:
    try:
        return machine_picture.moments(model, machine, columns, rows, size=(320, 120)).astype(int)
    except machine_picture.NoRenderer as reason:
        pytest.skip(str(reason))


def test_the_machine_is_drawn_where_it_is(model: mujoco.MjModel, machine: rig.Rig, columns: dict[str, np.ndarray]) -> None:
    standing, striding = drawn(model, machine, columns, [0]), drawn(model, machine, columns, [25])
    assert standing.shape == (120, 320, 3)
    changed = np.abs(standing - striding).sum(axis=2) > 60
    assert changed.any()
    left, right = np.flatnonzero(changed.any(axis=0))[[0, -1]]
    assert 100 < left < right < 220  # only about the one moment, which is in the middle


def test_more_moments_fill_more_of_the_picture(model: mujoco.MjModel, machine: rig.Rig, columns: dict[str, np.ndarray]) -> None:
    one, three = drawn(model, machine, columns, [0]), drawn(model, machine, columns, [0, 10, 20])
    assert not np.array_equal(one, three)


def test_without_a_renderer_it_is_a_plot(
    model: mujoco.MjModel, machine: rig.Rig, columns: dict[str, np.ndarray], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*arguments: object) -> None:
        raise machine_picture.NoRenderer("no display")

    monkeypatch.setattr(machine_picture, "moments", refuse)
    assert machine_picture.save(tmp_path / "walk.png", model, machine, columns) == "no display"
    assert imread(tmp_path / "walk.png").std() > 0.01
