"""Of a long recording a balance keeps every so many samples, behind the same filter, and says the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.motion import smoothing
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.motion_runs import motion_runs
from exo_sim.diagnosis.subsystems.motion.rows import rows_of
from exo_sim.diagnosis.subsystems.motion.smoothing import on_clock, smoothing_width, stride
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
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


def problem(rig: Rig, run: MotionRun) -> MotionModel:
    return MotionModel([run], PlantParameters(assembly.world(rig), assembly.cylinders(rig)), PARTS)


def test_the_filter_still_spans_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    for step in (2e-4, 1e-3, 4e-3, 2e-2):
        clock = np.arange(5000, dtype=float) * step
        assert stride(clock) == 1
        monkeypatch.setattr(smoothing, "MOST_SAMPLES", 10)
        every = stride(clock)
        assert every == 1 or smoothing_width(clock) >= smoothing.FEWEST_IN_FILTER * every * step * (1 - 1e-9)
        assert every == max(1, int(smoothing.SMOOTHING / step / smoothing.FEWEST_IN_FILTER + 1e-9))
        monkeypatch.undo()


def test_what_is_kept_is_what_was_there(rig: Rig, table: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = balance(rig, table)
    monkeypatch.setattr(smoothing, "MOST_SAMPLES", 1000)
    thin = balance(rig, table)
    assert whole.every == 1 and thin.every == 3
    terms: list[Callable[[MotionRun], np.ndarray]] = [
        lambda run: run.time, lambda run: run.kinematics.position, lambda run: run.kinematics.velocity, lambda run: run.inertia.force,
        lambda run: run.drive.force, lambda run: run.drive.gauge, lambda run: run.drive.arm,
    ]  # fmt: skip
    for term in terms:
        np.testing.assert_array_equal(term(thin), term(whole)[:: thin.every])
    assert thin.noise == whole.noise


def test_errors_count_as_much(rig: Rig, table: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = problem(rig, balance(rig, table))
    monkeypatch.setattr(smoothing, "MOST_SAMPLES", 1000)
    thin = problem(rig, balance(rig, table))
    assert thin.scale[0] == pytest.approx(whole.scale[0], rel=0.02)
    assert thin.size == pytest.approx(whole.size, rel=0.1)


def test_what_a_recording_says_reaches_the_samples_kept(rig: Rig, table: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(smoothing, "MOST_SAMPLES", 1000)
    thin = balance(rig, table)
    np.testing.assert_allclose(on_clock(thin, table.time, np.sin(table.time)), np.sin(thin.time), atol=1e-12)


def test_around_a_reversal_nothing_is_compared(rig: Rig, table: Recording) -> None:
    run = balance(rig, table)
    velocity = np.where(np.arange(len(run.time)) < 1500, 0.2, -0.2)  # no sample of it rests
    group = rows_of(replace(run, kinematics=replace(run.kinematics, velocity=velocity)), np.ones(len(run.time), dtype=bool)).group
    assert np.all(group[1490:1510] == -1) and np.any(group[1400:1480] >= 0) and np.any(group[1520:1600] >= 0)


def test_what_a_rig_says_of_the_friction_of_two_pistons_at_one_joint_is_no_missing_force(tmp_path: Path) -> None:
    """Dry friction, damping and a spring of each, through its own lever: nothing of it is lacking, and all of it without those tables."""
    known = (
        "[effects.coulomb_friction.piston]\nforce = '6 N'\n[effects.coulomb_friction.other]\nforce = '10 N'\n"
        "[effects.viscous_friction.other]\ncoefficient = '40 N s/m'\n"
    )
    rig = _pair(tmp_path, known)
    t = np.arange(3000) / 1000.0
    position, velocity, n = 0.04 * np.sin(2 * np.pi * t), 0.08 * np.pi * np.cos(2 * np.pi * t), len(t)
    acceleration = -((2 * np.pi) ** 2) * position
    area_1, area_2 = rig.cylinders["piston"].area_1, rig.cylinders["piston"].area_2
    resists = 16.0 * np.sign(velocity) + 40.0 * velocity
    columns = {f"{name}.pressure_{side}": np.full(n, 3e5) for name in ("piston", "other") for side in (1, 2)}
    columns |= {f"{name}.valve_command": np.zeros(n) for name in ("piston", "other")}
    columns["piston.pressure_1"] = 3e5 + (8.0 * acceleration + resists) / area_1
    standing = 2.0 * (3e5 - 101325.0) * (area_1 - area_2)  # what equal pressures push: the other piston the other way
    run = balance(rig, benches.recording(t, {**columns, "slide.position": position}))
    bare = balance(_pair(tmp_path, ""), benches.recording(t, {**columns, "slide.position": position}))
    assert run.drive.cylinder is None and standing > 0.0
    far = np.abs(run.kinematics.velocity) > 0.1
    for one, left in ((run, 0.0), (bare, 16.0 + 40.0 * float(np.mean(np.abs(velocity[far]))))):
        lacks = (one.drive.force - one.demand) * np.sign(one.kinematics.velocity)
        assert float(np.mean(lacks[far])) == pytest.approx(left, abs=0.3)


def _pair(folder: Path, more: str) -> Rig:
    """Return a mass on a slide between two cylinders that push against each other."""
    rig = benches.bench(folder)
    own = benches.CYLINDER.split("[cylinders.piston]")[1]
    text = rig.text + "[cylinders.other]" + own.replace("cylinders.piston", "cylinders.other").replace('"piston"', '"other"') + more
    model = benches.MODEL.format(
        actuator='<tendon><fixed name="back"><joint joint="slide" coef="-1"/></fixed></tendon>'
        '<actuator><motor name="piston" joint="slide"/><motor name="other" tendon="back"/></actuator>'
    )
    (folder / "bench.xml").write_text(model)
    path = folder / "pair.toml"
    path.write_text(text)
    return rigs.read(path)
