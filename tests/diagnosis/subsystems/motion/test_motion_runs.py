"""Which filter a balance is behind: the usual one, a wider one for noise, a narrower one for a machine that turns round soon."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.policy.recordings import LEAST_COMPARED, ROWS_ENOUGH
from exo_sim.diagnosis.subsystems.motion.filter_width import asked_width
from exo_sim.diagnosis.subsystems.motion.motion_runs import motion_runs
from exo_sim.diagnosis.subsystems.motion.rows import rows_of
from exo_sim.diagnosis.subsystems.motion.smoothing import SMOOTHING, smoothing_width
from exo_sim.machine.rig_model import load
from exo_sim.recording import Recording

TIME = np.arange(0.0, 10.0, 0.001)
MASS, DAMPING = 8.0, 60.0


def swinging(frequency: float, noise: float = 1e-6) -> Recording:
    """Return a slide that an outside force swings by 20 mm; it is damped, and its rig does not know of it."""
    w = 2.0 * np.pi * frequency
    position = 0.02 * np.sin(w * TIME)
    force = -MASS * w**2 * position + DAMPING * 0.02 * w * np.cos(w * TIME)
    position = position + noise * np.random.default_rng(1).standard_normal(TIME.size)
    return benches.recording(TIME, {"slide.external_force": force, "slide.position": position})


def balance(folder: Path, table: Recording) -> MotionRun:
    rig = benches.bench(folder, cylinder=False)
    return motion_runs(table, rig, load(rig), ())[0][0]


def compared(run: MotionRun) -> float:
    moves = np.abs(run.kinematics.velocity) > run.kinematics.still
    return float(rows_of(run, moves).compared.sum() / moves.sum())


def test_a_slow_machine_has_the_usual_filter(tmp_path: Path) -> None:
    run = balance(tmp_path, swinging(1.0))
    assert run.smoothing == 0.0 and smoothing_width(run.time, run.smoothing) == SMOOTHING and compared(run) > LEAST_COMPARED


@pytest.mark.parametrize("frequency", [9.0, 12.0])
def test_a_machine_that_turns_round_soon_has_a_narrower_one(tmp_path: Path, frequency: float) -> None:
    run = balance(tmp_path, swinging(frequency))
    assert 0.0 < run.smoothing < SMOOTHING and compared(run) > LEAST_COMPARED
    rows = rows_of(run, np.ones(TIME.size, dtype=bool))
    lacking, speed = rows.means(run.driving - run.inertia.force), rows.means(run.kinematics.velocity)
    assert float(lacking @ speed / (speed @ speed)) == pytest.approx(DAMPING, rel=0.02)


def test_noise_asks_for_a_wider_one_however_soon_it_turns_round(tmp_path: Path) -> None:
    assert balance(tmp_path, swinging(1.0, 1e-3)).smoothing > SMOOTHING
    assert balance(tmp_path, swinging(9.0, 1e-3)).smoothing >= 0.0


def test_no_filter_leaves_too_few_rows_of_a_machine_that_turns_round_soon(tmp_path: Path) -> None:
    table = swinging(6.0, 3e-4)
    asked = asked_width(table.time, [table["slide.position"]]).seconds
    run = balance(tmp_path, table)
    every = np.ones(TIME.size, dtype=bool)
    assert smoothing_width(run.time, run.smoothing) < asked
    assert rows_of(run, every).block.size >= ROWS_ENOUGH > rows_of(replace(run, smoothing=asked), every).block.size


def test_what_was_not_recorded_is_what_to_record(tmp_path: Path) -> None:
    rig = benches.bench(tmp_path, cylinder=False)
    table = benches.recording(TIME, {"slide.external_force": np.zeros(TIME.size)})
    runs, ((joint, unjudged),) = motion_runs(table, rig, load(rig), ())
    assert (runs, joint, unjudged.do) == ([], "slide", "record slide.position as well")
