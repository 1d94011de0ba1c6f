"""Onsets of motion: found behind rests, read at their peak, and never higher than what it takes to start."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from diagnosis import motion_runs, starts

from exo_sim.diagnosis.subsystems.motion.missing_force import MissingForce, MissingOnsets
from exo_sim.diagnosis.subsystems.motion.onsets import Onsets, Starting, onsets_of
from exo_sim.recording.filters import gaussian_smoothed

ALL = np.ones(starts.TIME.size, dtype=bool)
READ = Starting(starts.DAMPING)


def read(run: starts.MotionRun, usable: np.ndarray = ALL, starting: Starting = READ) -> Onsets:
    return onsets_of(run, usable, -MissingForce(run).of(motion_runs.plant()), starting)


def test_every_motion_behind_a_rest_has_one_where_it_begins() -> None:
    found = read(starts.run())
    inner = starts.BEGINS[1:-1]
    apart = np.abs(found.at[:, None] - inner[None, :]).min(axis=0)
    assert (apart < 40).all() and len(found.at) >= len(inner)
    np.testing.assert_array_equal(found.way, np.sign(starts.VELOCITY[found.at + 60]))
    assert (found.acceleration > 0.0).all() and (found.fastest > found.slowest).all()


def peaks_of(run: starts.MotionRun, found: Onsets) -> np.ndarray:
    """Return what resists at each onset beside the damping, against the motion [N]."""
    return found.way * (found.means(-MissingForce(run).of(motion_runs.plant())) - found.damped)


@pytest.mark.parametrize("excess", [0.0, 6.0, 20.0])
def test_the_peak_is_no_higher_than_what_it_takes_to_start(excess: float) -> None:
    run = starts.run(excess)
    peaks = peaks_of(run, read(run))
    assert (peaks < starts.LEVEL + excess + 3.0 * run.noise).all()
    assert not excess or np.median(peaks) > starts.LEVEL + 0.2 * excess


@pytest.mark.parametrize("excess", [0.0, 6.0, 20.0])
def test_the_true_law_explains_the_peaks_behind_the_filter(excess: float) -> None:
    run, plant = starts.run(excess), motion_runs.plant()
    plant.cylinder["coulomb_friction"]["force"], plant.cylinder["viscous_friction"]["coefficient"] = starts.LEVEL, starts.DAMPING
    if excess:
        dip = plant.cylinder["stribeck_friction"]
        dip["breakaway"], dip["velocity"], dip["exponent"] = starts.LEVEL + excess, starts.DIP, 1.0
    found = read(run)
    left = found.way * MissingOnsets(run, found).of(plant)
    assert abs(float(np.median(left))) < 0.03 * starts.LEVEL + 0.1 * excess


def test_a_level_of_dry_friction_counts_whole_at_an_onset() -> None:
    run = starts.run(6.0)
    found, plant = read(run), motion_runs.plant()
    bare = MissingOnsets(run, found).of(plant)
    plant.cylinder["coulomb_friction"]["force"] = 9.0
    np.testing.assert_allclose(MissingOnsets(run, found).of(plant) - bare, 9.0 * found.way, rtol=1e-9)


def test_without_a_rest_before_it_or_outside_the_time_that_may_be_used_there_is_none() -> None:
    run = starts.run()
    swinging = replace(run.kinematics, velocity=np.sin(4.0 * starts.TIME))
    assert read(replace(run, kinematics=swinging)).at.size == 0
    late = read(run, starts.TIME > 6.0)
    assert late.at.size and (starts.TIME[late.at] > 5.9).all()


def test_what_differs_from_one_onset_to_the_next_makes_each_worth_less() -> None:
    run = starts.run()
    plain, scattered = read(run), read(run, starting=Starting(starts.DAMPING, 3.0))
    np.testing.assert_allclose(scattered.scale, np.hypot(plain.scale, 3.0))


def test_a_law_that_builds_up_with_speed_is_asked_for_its_most() -> None:
    """A contact that takes a few millimetres a second to grip resists as much, once it slides, as one that grips at once."""
    run = starts.run(6.0)
    found, plant = read(run), motion_runs.plant()
    plant.cylinder["coulomb_friction"]["force"] = 9.0
    at_once = MissingOnsets(run, found).of(plant)
    plant.cylinder["friction_smoothing"]["velocity"] = 2e-3
    np.testing.assert_allclose(MissingOnsets(run, found).of(plant), at_once, atol=0.1 * 9.0)


def most_memory(repeated: int) -> int:
    """Return what it takes at most to read a recording that is repeated so many times [bytes]."""
    one = starts.run(6.0)
    run = replace(
        one, time=np.arange(starts.TIME.size * repeated, dtype=float) * 1e-3, external=np.tile(one.external, repeated),
        kinematics=replace(
            one.kinematics, position=np.tile(starts.POSITION, repeated), velocity=np.tile(one.kinematics.velocity, repeated)
        ),
        inertia=replace(one.inertia, force=np.tile(one.inertia.force, repeated)),
        drive=replace(one.drive, force=np.tile(one.drive.force, repeated), arm=np.tile(one.drive.arm, repeated)),
    )  # fmt: skip
    tracemalloc.start()
    found = onsets_of(run, np.ones(run.time.size, dtype=bool), run.external - run.inertia.force, READ)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert found.at.size >= 10 * repeated
    return most


def test_memory_goes_with_the_length_of_a_recording() -> None:
    assert most_memory(4) < 6 * most_memory(1)


TRUE = {"coulomb_friction": {"force": starts.LEVEL}, "viscous_friction": {"coefficient": starts.DAMPING}}


def missed(run: starts.MotionRun, excess: float, dip: float = starts.DIP) -> np.ndarray:
    """Return by how much the true law exceeds each measured peak [N]."""
    plant = motion_runs.plant()
    laws = {**TRUE, "stribeck_friction": {"breakaway": starts.LEVEL + excess, "velocity": dip, "exponent": 1.0}} if excess else TRUE
    for effect, numbers in laws.items():
        for name, value in numbers.items():
            plant.cylinder[effect][name] = value
    found = read(run)
    return np.asarray(found.way * MissingOnsets(run, found).of(plant))


def noisy(excess: float, noise: float, of_accelerations: bool, seed: int) -> starts.MotionRun:
    """Return a balance with noise of that standard deviation behind the filter, of a force or of accelerations [N]."""
    run = starts.run(excess, 0.0)
    white = gaussian_smoothed(starts.TIME, np.random.default_rng(seed).standard_normal(starts.TIME.size), 0.031)
    if of_accelerations:
        white = np.gradient(np.gradient(white, starts.TIME), starts.TIME)
    external = run.external + noise * white / white.std()
    return replace(run, external=external, noise=noise, inertia=replace(run.inertia, noise=noise * of_accelerations))


@pytest.mark.parametrize("of_accelerations", [False, True])
@pytest.mark.parametrize("excess", [0.0, 10.0])
def test_noise_makes_no_peak_seem_higher_or_lower_on_the_mean(excess: float, of_accelerations: bool) -> None:
    noise = 0.1
    plain = float(np.mean(missed(noisy(excess, 1e-9, of_accelerations, 0), excess)))
    left = np.concatenate([missed(noisy(excess, noise, of_accelerations, seed), excess) for seed in range(12)])
    assert abs(float(np.mean(left)) - plain) < 0.3 * noise


def test_a_peak_does_not_hang_on_the_speed_that_counts_as_moving() -> None:
    """Faster strokes elsewhere, or a poorer encoder, raise that speed."""
    run = starts.run(10.0)
    ways = [replace(run, kinematics=replace(run.kinematics, still=still)) for still in (1e-3, 5e-3, 1e-2)]
    peaks = [float(np.median(read(one).peak)) for one in ways]
    left = [float(np.median(missed(one, 10.0))) for one in ways]
    assert np.ptp(peaks) < 0.05 * 10.0 and np.ptp(left) < 0.05 * 10.0 and np.abs(left).max() < 0.1 * 10.0
    assert read(replace(run, kinematics=replace(run.kinematics, still=0.03))).at.size == 0  # it began long before that
