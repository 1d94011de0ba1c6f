"""Of a long recording a balance keeps every so many samples, behind the same filter, and says the same."""

from __future__ import annotations

from dataclasses import replace

import benches
import numpy as np
import pytest

from exo_sim.diagnosis import motion_cut
from exo_sim.diagnosis.gas_problem import GasProblem
from exo_sim.diagnosis.motion_cut import MotionRun, kept, motion_runs, on_clock
from exo_sim.diagnosis.motion_problem import MotionProblem
from exo_sim.diagnosis.observed import cylinder_runs
from exo_sim.diagnosis.quantity import Setting
from exo_sim.diagnosis.split import Split
from exo_sim.machine.linkage import linkages
from exo_sim.machine.load import load
from exo_sim.recording import Recording
from exo_sim.rig import Rig, assembly

PARTS = Split({})


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return benches.bench(tmp_path_factory.mktemp("long"))


@pytest.fixture(scope="module")
def table(rig: Rig) -> Recording:
    return benches.led(rig, 3.0)


def balance(rig: Rig, table: Recording) -> MotionRun:
    model = load(rig)
    return motion_runs(table, rig, model, linkages(rig, model))[0][0]


def problem(rig: Rig, run: MotionRun) -> MotionProblem:
    return MotionProblem([run], Setting(assembly.world(rig), assembly.cylinders(rig)), PARTS)


def test_the_filter_still_spans_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    for step in (2e-4, 1e-3, 4e-3, 2e-2):
        clock = np.arange(5000) * step
        assert kept(clock) == 1
        monkeypatch.setattr(motion_cut, "MOST_SAMPLES", 10)
        every = kept(clock)
        assert every == 1 or motion_cut.smoothing(clock) >= motion_cut.FEWEST_IN_FILTER * every * step * (1 - 1e-9)
        assert every == max(1, int(motion_cut.SMOOTHING / step / motion_cut.FEWEST_IN_FILTER + 1e-9))
        monkeypatch.undo()


def test_what_is_kept_is_what_was_there(rig: Rig, table: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = balance(rig, table)
    monkeypatch.setattr(motion_cut, "MOST_SAMPLES", 1000)
    thin = balance(rig, table)
    assert whole.every == 1 and thin.every == 3
    for name in ("time", "position", "velocity", "inertial", "drive", "gauge", "arm"):
        np.testing.assert_array_equal(getattr(thin, name), getattr(whole, name)[:: thin.every])
    assert thin.noise == whole.noise


def test_errors_count_as_much(rig: Rig, table: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = problem(rig, balance(rig, table))
    monkeypatch.setattr(motion_cut, "MOST_SAMPLES", 1000)
    thin = problem(rig, balance(rig, table))
    assert thin.scale[0] == pytest.approx(whole.scale[0], rel=0.02)
    assert thin.size == pytest.approx(whole.size, rel=0.1)


def test_what_a_recording_says_reaches_the_samples_kept(rig: Rig, table: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(motion_cut, "MOST_SAMPLES", 1000)
    thin = balance(rig, table)
    np.testing.assert_allclose(on_clock(thin, table.time, np.sin(table.time)), np.sin(thin.time), atol=1e-12)


def test_a_prediction_of_nothing_but_pressures_is_the_same(rig: Rig, table: Recording) -> None:
    model = load(rig)
    setting = Setting(assembly.world(rig), assembly.cylinders(rig))
    gas = GasProblem(cylinder_runs(table, rig, model, linkages(rig, model)), setting, PARTS)
    whole, plain = gas.predict(setting, 0), gas.predict(setting, 0, whole=False)
    np.testing.assert_array_equal(plain.pressure, whole.pressure)
    assert plain.drawn.size == plain.inside.size == plain.temperature.size == 0
    measured = np.column_stack([table["piston.pressure_1"], table["piston.pressure_2"]])
    np.testing.assert_array_equal(gas.errors(setting)[0], measured[: len(whole.pressure)] - whole.pressure)


def test_around_a_reversal_nothing_is_compared(rig: Rig, table: Recording) -> None:
    run = balance(rig, table)
    velocity = np.where(np.arange(len(run.time)) < 1500, 0.2, -0.2)  # no sample of it rests
    group = problem(rig, replace(run, velocity=velocity))._groups[0]
    assert np.all(group[1490:1510] == -1) and np.any(group[1400:1480] >= 0) and np.any(group[1520:1600] >= 0)
