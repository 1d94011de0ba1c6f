"""What a filter bridges over a hole is no force: nothing is compared there, nor beside it within the filter's reach."""

from __future__ import annotations

from dataclasses import replace

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.data.cylinder_run import cylinder_runs
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.subsystems.motion.forces_recorded import recorded
from exo_sim.diagnosis.subsystems.motion.load_cell import rod_run
from exo_sim.diagnosis.subsystems.motion.motion_runs import motion_runs
from exo_sim.diagnosis.subsystems.motion.rows import rows_of
from exo_sim.diagnosis.subsystems.motion.smoothing import reach
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.recording import Recording
from exo_sim.rig import Rig

#: Samples of the hole.
HOLE = slice(1200, 1500)


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return benches.bench(tmp_path_factory.mktemp("holes"))


def table(rig: Rig, holed: str = "") -> Recording:
    """Return a piston led to and fro by a measured force, of whose columns one has a hole."""
    led = benches.led(rig, 3.0)
    columns = {**led.columns, "slide.external_force": np.sin(led.time), "piston.force": np.cos(led.time)}
    if holed:
        columns[holed] = columns[holed].copy()
        columns[holed][HOLE] = np.nan
    return benches.recording(led.time, columns)


def compared(run: MotionRun) -> np.ndarray:
    return np.asarray(rows_of(run, np.ones(len(run.time), dtype=bool)).compared)


def joint_run(rig: Rig, one: Recording) -> MotionRun:
    model = load(rig)
    return motion_runs(one, rig, model, linkages(rig, model))[0][0]


@pytest.mark.parametrize("column", ["piston.force", "slide.external_force", "slide.position"])
def test_nothing_is_compared_in_a_hole(rig: Rig, column: str) -> None:
    run = joint_run(rig, table(rig, column))
    beside = reach(run.time)
    near = slice(HOLE.start - beside, HOLE.stop + beside)
    assert compared(joint_run(rig, table(rig)))[near].any()
    assert not compared(run)[near].any() and not run.judged[near].any()
    assert compared(run)[: near.start].any() and compared(run)[near.stop :].any()


@pytest.mark.parametrize("column", ["piston.pressure_1", "piston.pressure_2"])
def test_a_hole_in_a_driving_pressure_is_no_force(rig: Rig, column: str) -> None:
    one = table(rig, column)
    bare = replace(one, columns={key: values for key, values in one.columns.items() if key != "piston.force"})
    assert not compared(joint_run(rig, bare))[HOLE].any() and compared(joint_run(rig, bare)).any()
    assert compared(joint_run(rig, one))[HOLE].any()  # a load cell stands for the pressures


@pytest.mark.parametrize("column", ["piston.pressure_1", "piston.force"])
def test_nor_along_a_rod(rig: Rig, column: str) -> None:
    model = load(rig)
    (run,) = cylinder_runs(table(rig, column), rig, model, linkages(rig, model))
    rod = rod_run(run, rig)
    assert rod is not None and not compared(rod)[HOLE].any() and compared(rod).any()


def test_how_large_a_chamber_is_nobody_knows_in_a_hole_of_the_position(rig: Rig) -> None:
    """Nor is its pressure compared there, by the gas or along a rod."""
    model = load(rig)
    (run,) = cylinder_runs(table(rig, "slide.position"), rig, model, linkages(rig, model))
    for pressure in run.pressure:
        assert pressure is not None and np.isnan(pressure[HOLE]).all() and np.isfinite(np.delete(pressure, HOLE)).all()
    rod = rod_run(run, rig)
    assert rod is not None and not compared(rod)[HOLE].any()


def test_a_lone_missing_sample_is_bridged() -> None:
    time = np.linspace(0.0, 1.0, 1001)
    values = np.sin(time)
    values[::7] = np.nan
    assert recorded(time, [values, None]).all()


def test_a_joint_of_which_a_column_is_hardly_there_is_not_judged_and_the_column_is_named(rig: Rig) -> None:
    one = table(rig)
    columns = {**one.columns, "slide.external_force": np.where(one.time % 0.5 < 0.02, one["slide.external_force"], np.nan)}
    model = load(rig)
    runs, reasons = motion_runs(replace(one, columns=columns), rig, model, linkages(rig, model))
    assert not runs and "slide.external_force" in reasons[0][1].why
