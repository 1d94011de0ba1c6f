"""When a gait's moments are not to be relied on, and that a run says so before all else."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from gait.walked_trial import walked

import exo_sim as exo
from exo_sim.cli.run import _words
from exo_sim.gait import own_gait
from exo_sim.recording import Recording
from exo_sim.recording.table_file import write_table
from exo_sim.simulation.residual_guideline import BEYOND, FORCE, MOMENT, unreliable

Angles = dict[str, np.ndarray]


@pytest.fixture
def written(tmp_path: Path) -> Callable[[Angles], Path]:
    def write(angles: Angles) -> Path:
        columns = {f"{'torso_pitch' if name == 'tilt' else name}.position": values for name, values in angles.items()}
        write_table(tmp_path / "lab.csv", Recording("lab", walked().time, columns, dict.fromkeys(columns, "rad"), {}))
        return tmp_path / "lab.csv"

    return write


def swapped() -> Angles:
    """Somebody took the left hip for the right one, and left the pelvis out."""
    angles = dict(walked().angles)
    angles["hip_l"], angles["hip_r"] = angles["hip_r"], angles["hip_l"]
    del angles["tilt"]
    return angles


@pytest.mark.parametrize(("force", "moment", "said"), [(0.99, 0.99, False), (1.01, 0.0, True), (0.0, 1.01, True)])
def test_ten_times_the_guideline_is_too_much(force: float, moment: float, said: bool) -> None:
    residual = np.zeros((5, 3))
    residual[2] = [-0.6 * force * BEYOND * FORCE, 0.8 * force * BEYOND * FORCE, -moment * BEYOND * MOMENT]
    assert (unreliable("lab", residual, ()) is not None) == said


def test_doubts_are_what_is_named() -> None:
    residual = np.full((1, 3), 1e3)
    said = unreliable("lab", residual, ("the pelvis's tilt is missing", "a foot on the ground slides or sinks by 50 mm"))
    assert said is not None and said.startswith("lab: moments and metabolic power of this gait are not to be relied on")
    assert said.endswith("perhaps because the pelvis's tilt is missing, and because a foot on the ground slides or sinks by 50 mm")
    assert (unreliable("lab", residual, ()) or "").endswith("are unit, clock and columns of its angles right?")


def test_a_gait_knows_what_may_be_wrong_with_it(written: Callable[[Angles], Path]) -> None:
    assert own_gait.scenario(own_gait.GaitFile(written(dict(walked().angles)))).doubts == ()
    signs, tilt, foot = own_gait.scenario(own_gait.GaitFile(written(swapped()))).doubts or ()
    assert "signs or zeros" in signs and "tilt is missing" in tilt and "slides or sinks by" in foot


def test_a_run_says_it_in_its_first_line(written: Callable[[Angles], Path]) -> None:
    run = exo.simulate(gait=written(swapped()), assist="vented", strides=1)
    first = run.summary["unreliable"]
    assert run.remarks[0] == first and str(run).startswith(first)
    assert "the pelvis's tilt is missing" in first and "slides or sinks by" in first
    lines = _words({**run.summary, "recording": "lab.rrd", "table": "lab.parquet"}).splitlines()
    assert lines[0] == first


def test_of_a_gait_that_a_body_can_do_nothing_is_said(written: Callable[[Angles], Path]) -> None:
    run = exo.simulate(gait=written(dict(walked().angles)), assist="vented", strides=1)
    assert "unreliable" not in run.summary and "relied" not in " ".join(run.remarks)
    assert _words({**run.summary, "recording": "lab.rrd", "table": "lab.parquet"}).startswith("lab: ")
