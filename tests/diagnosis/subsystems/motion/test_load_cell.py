"""The rod's balance in closed form, and one filter for what is measured and what is predicted."""

from __future__ import annotations

from dataclasses import replace

import benches
import numpy as np
import pytest
from diagnosis import cylinder_runs
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import erf

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.cylinder_run import cylinder_runs as runs_of
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.subsystems.motion import smoothing
from exo_sim.diagnosis.subsystems.motion.load_cell import rod_run
from exo_sim.diagnosis.subsystems.motion.smoothing import SMOOTHING, smoothed_alike
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.recording.filters import gaussian_derivatives
from exo_sim.rig import Rig

N = 1200
TIME = np.arange(N, dtype=float) * cylinder_runs.STEP
INSIDE = slice(60, N - 60)  # beyond what the filter sees of the ends


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return benches.bench(tmp_path_factory.mktemp("rod"))


def pulled(rig: Rig, lost: np.ndarray) -> CylinderRun:
    """Return a piston led to and fro whose load cell shows the pressures' force less what the piston loses [N]."""
    c = rig.cylinders["piston"]
    p_1, p_2 = 3e5 + 8e4 * np.sin(5.0 * TIME), 4e5 - 5e4 * TIME
    air = rig.environment.pressure
    force = (p_1 - air) * c.area_1 - (p_2 - air) * c.area_2 - lost
    return cylinder_runs.run_of(p_1, p_2, length=0.1 + 0.04 * np.sin(3.0 * TIME), force=force)


def balance(run: MotionRun | None) -> np.ndarray:
    assert run is not None
    return run.drive.force - run.inertia.force


def test_what_is_missing_along_the_rod_is_what_the_piston_loses(rig: Rig) -> None:
    lost = 40.0 * np.tanh(np.cos(3.0 * TIME) / 0.2) + 6.0 * np.cos(3.0 * TIME)
    one = rod_run(pulled(rig, lost), rig)
    np.testing.assert_allclose(balance(one)[INSIDE], lost[INSIDE], atol=0.3)
    assert one is not None and (one.joint, one.cylinder, one.inertia.has_mass, one.turning) == ("piston", "piston", False, False)
    np.testing.assert_allclose(one.kinematics.velocity[INSIDE], 0.12 * np.cos(3.0 * TIME)[INSIDE], atol=1e-4)
    assert (one.inertia.force == one.inertia.bias).all()  # no mass moves along a rod that is cut through
    for other in (one.inertia.tilt, one.passive.force, one.external):
        assert not other.any()


@given(seed=st.integers(0, 10**6))
def test_what_is_lost_passes_the_filter_of_predicted_forces(rig: Rig, seed: int) -> None:
    lost = 30.0 * np.random.default_rng(seed).standard_normal(N)
    np.testing.assert_allclose(balance(rod_run(pulled(rig, lost), rig)), smoothed_alike(TIME, lost), atol=1e-6)


def test_each_lever_says_what_one_unit_too_much_does(rig: Rig) -> None:
    run = pulled(rig, np.zeros(N))
    plain = rod_run(run, rig)
    assert plain is not None and set(plain.drive.levers) == {"piston.pressure_1", "piston.pressure_2", "piston.force"}
    p_1, p_2 = run.pressure
    assert p_1 is not None and p_2 is not None and run.force is not None
    for column, more in {
        "piston.pressure_1": replace(run, pressure=(p_1 + 1e3, p_2)),
        "piston.pressure_2": replace(run, pressure=(p_1, p_2 + 1e3)),
        "piston.force": replace(run, force=run.force + 1e3),
    }.items():
        np.testing.assert_allclose(balance(rod_run(more, rig)) - balance(plain), 1e3 * plain.drive.levers[column], rtol=1e-6)


def test_of_a_long_recording_one_of_several_samples_is_kept(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    run = replace(pulled(rig, 40.0 * np.cos(3.0 * TIME)), breaks=(0, 600))
    whole = rod_run(run, rig)
    monkeypatch.setattr(smoothing, "MOST_SAMPLES", N // 3)
    kept = rod_run(run, rig)
    assert whole is not None and kept is not None and (whole.every, kept.every) == (1, 3) and kept.breaks == (0, 200)
    for one, other in (
        (kept.time, whole.time), (balance(kept), balance(whole)), (kept.drive.gauge, whole.drive.gauge),
        (kept.kinematics.position, whole.kinematics.position), (kept.kinematics.velocity, whole.kinematics.velocity),
    ):  # fmt: skip
        np.testing.assert_array_equal(one, other[::3])
    lengths = {len(one) for one in (*kept.drive.levers.values(), *kept.drive.signals.values(), kept.external, kept.drive.arm)}
    assert lengths == {len(kept.time)} and kept.noise == whole.noise


def test_pressure_is_counted_from_the_atmosphere(rig: Rig) -> None:
    air = np.full(N, rig.environment.pressure)
    run = rod_run(cylinder_runs.run_of(air, air, force=np.full(N, -12.0)), rig)
    assert run is not None
    np.testing.assert_allclose(run.drive.gauge, 0.0, atol=1e-6)
    np.testing.assert_allclose(balance(run), 12.0, rtol=1e-9)


@pytest.mark.parametrize("missing", ["force", "length", "pressure_1", "pressure_2"])
def test_without_one_of_them_there_is_no_balance(rig: Rig, missing: str) -> None:
    run = pulled(rig, np.zeros(N))
    p_1, p_2 = run.pressure
    assert rod_run(run, rig) is not None
    less = {
        "force": replace(run, force=None),
        "length": replace(run, length=None),
        "pressure_1": replace(run, pressure=(None, p_2)),
        "pressure_2": replace(run, pressure=(p_1, None)),
    }[missing]
    assert rod_run(less, rig) is None


def test_a_single_acting_cylinder_needs_one_pressure_only(rig: Rig) -> None:
    single = replace(rig, cylinders={"piston": replace(rig.cylinders["piston"], single_acting=True)})
    p_1 = 2e5 + 3e4 * TIME
    force = (p_1 - rig.environment.pressure) * rig.cylinders["piston"].area_1 - 7.0
    for p_2 in (None, np.full(N, 4e5)):
        run = rod_run(cylinder_runs.run_of(p_1, p_2, force=force), single)
        np.testing.assert_allclose(balance(run)[INSIDE], 7.0, rtol=1e-6)
        assert run is not None and set(run.drive.levers) == {"piston.pressure_1", "piston.force"}


@given(seed=st.integers(0, 10**6), step=st.sampled_from([2e-4, 1e-3, 4e-3, 0.02]))
def test_predictions_pass_the_very_filter_of_measurements(seed: int, step: float) -> None:
    time = np.arange(2500, dtype=float) * step
    values = np.cumsum(np.random.default_rng(seed).standard_normal(2500))
    np.testing.assert_allclose(smoothed_alike(time, values), gaussian_derivatives(time, values, max(SMOOTHING, 6.0 * step))[0], atol=1e-9)


def test_a_reversal_becomes_a_normal_distribution() -> None:
    width = SMOOTHING / 4.0
    step = np.where(TIME < 0.6, -1.0, 1.0)
    exact = erf((TIME - (0.6 - 0.5 * cylinder_runs.STEP)) / (np.sqrt(2.0) * width))
    np.testing.assert_allclose(smoothed_alike(TIME, step), exact, atol=2e-3)


@pytest.mark.parametrize("noise", [1e-5, 1e-4])
def test_a_rod_rests_within_what_its_own_sensor_shakes(rig: Rig, noise: float) -> None:
    clean = benches.led(rig)
    shaken = clean["slide.position"] + noise * np.random.default_rng(2).standard_normal(len(clean.time))
    columns = {**clean.columns, "slide.position": shaken, "piston.force": np.zeros_like(clean.time)}
    model = load(rig)
    (run,) = runs_of(benches.recording(clean.time, columns), rig, model, linkages(rig, model))
    assert run.position_noise == pytest.approx(noise, rel=0.1)
    one = rod_run(run, rig)
    assert one is not None
    error = one.kinematics.velocity - 0.08 * np.pi * np.cos(2.0 * np.pi * clean.time)
    assert one.kinematics.still > 3.0 * np.std(error[INSIDE])
