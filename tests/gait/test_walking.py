"""How load and centre of pressure go through a step, held against both recordings."""

from pathlib import Path

import numpy as np
import pytest
from machine.test_published_walk import segments
from scipy.io import loadmat

from exo_sim.gait import recorded_gait, scenario
from exo_sim.gait.motion import phases
from exo_sim.gait.residual_reduction import reduced
from exo_sim.gait.walking import loaded, pressure_centres, pressure_course, shares
from exo_sim.machine.ground_reaction import TOES
from exo_sim.machine.person import Person
from exo_sim.recording.opensim_table import read_storage

PHASE = np.arange(0.0, 1.0, 0.002)
PERSON = Person()


def of_falisse(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return force of the ground on the right foot over the body weight, ahead and up, shape (2, n), and the centre of pressure [m]."""
    gait = recorded_gait.load("falisse")
    data = loadmat(folder / "walking_falisse" / "ExperimentalData.mat", squeeze_me=True, struct_as_record=False)["ExperimentalData"]
    measured = data.GRFs.subject1.mean[:, :2] * 0.5 / data.GRFs.subject1.mean[:, 1].mean()
    force = np.stack([np.interp(PHASE, np.arange(100) / 100, column, period=1.0) for column in measured.T])
    foot = sum(gait.recorded[name](PHASE) for name in ("thigh", "knee", "ankle")) + gait.ankle_offset
    ahead = force[1] * np.sin(foot) + force[0] * np.cos(foot)
    down = np.maximum(force[1] * np.cos(foot) - force[0] * np.sin(foot), 1e-2)
    return force, (-gait.moment["ankle"](PHASE) / (9.81 * gait.mass) - PERSON.ankle_height * ahead) / down


def of_opensim(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertical force on both feet, the own one first, shape (2, n), and the centre of pressure [m], mean of all strides."""
    angles, plates = (read_storage(folder / "walking_opensim" / f"subject01_walk_{name}") for name in ("IK.mot", "grf.mot"))
    poses, _, _ = segments(angles)
    loads, centres = [], []
    for leg, own, other in ((0, "1_", ""), (1, "", "1_")):
        up = plates.columns[f"{own}ground_force_vy"]
        strikes = plates.time[1:][(up[1:] > 20.0) & (up[:-1] <= 20.0)]
        strikes = strikes[np.concatenate([[True], np.diff(strikes) > 0.8])]
        foot = poses[:, 3 + 3 * leg]
        x, z = (np.interp(angles.time, plates.time, plates.columns[f"{own}ground_force_p{axis}"]) for axis in "xy")
        centre = (x - foot[:, 0]) * np.cos(foot[:, 2]) + (z - foot[:, 1]) * np.sin(foot[:, 2])
        for start, stop in zip(strikes, strikes[1:]):
            at = start + PHASE * (stop - start)
            loads.append([np.interp(at, plates.time, plates.columns[f"{side}ground_force_vy"]) for side in (own, other)])
            centres.append(np.interp(at, angles.time, centre))
    return np.mean(loads, axis=0), np.mean(centres, axis=0)


@pytest.mark.real_data
def test_the_centre_of_pressure_goes_as_under_recorded_feet(shared_data: Path) -> None:
    """From heel to ball over the whole of stance, as it went until then, it was 23 mm behind Falisse's and 35 mm behind OpenSim's."""
    for name, (force, centre) in (("falisse", of_falisse(shared_data)), ("opensim", of_opensim(shared_data))):
        stance = PHASE / recorded_gait.load(name).stance_end
        up = force[1] if name == "falisse" else force[0]
        stands = stance < 0.98
        off = pressure_course(stance[stands]) - centre[stands]
        assert np.sqrt(np.average(off**2, weights=np.maximum(up[stands], 0.0))) < 0.012, name


@pytest.mark.real_data
def test_the_centre_that_is_walked_with_is_farther_from_one_recording(shared_data: Path) -> None:
    """Residual reduction shifts the course: by less than a millimetre for Falisse's walk, by 14 mm back for OpenSim's."""
    for name, scene, (force, centre), shift, most in (
        ("falisse", "level_walk", of_falisse(shared_data), 0.001, 0.010),
        ("opensim", "level_walk_opensim", of_opensim(shared_data), 0.015, 0.026),
    ):
        gait = recorded_gait.load(name)
        person = Person(1.70, gait.mass)
        plain = scenario.motion(scene, person, 1.0)
        walked = reduced(plain, person).pressure_centre[:, 1]
        inside = np.abs(phases() / gait.stance_end - 0.5) < 0.3  # near its ends the course may be cut off
        moved = (walked - plain.pressure_centre[:, 1])[inside]
        assert np.ptp(moved) < 1e-9 and abs(moved[0]) < shift, name
        stands = PHASE / gait.stance_end < 0.98
        off = np.interp(PHASE[stands], phases(), walked) - centre[stands]
        up = np.maximum((force[1] if name == "falisse" else force[0])[stands], 0.0)
        assert np.sqrt(np.average(off**2, weights=up)) < most, name


@pytest.mark.real_data
def test_the_load_passes_as_between_recorded_feet(shared_data: Path) -> None:
    up, both = of_falisse(shared_data)[0][1], of_opensim(shared_data)[0]
    up = np.maximum(up, 0.0)
    for name, share, most in (("falisse", up / (up + np.roll(up, len(up) // 2)), 0.030), ("opensim", both[0] / both.sum(axis=0), 0.018)):
        ours = shares((PHASE + 0.5) % 1.0, PHASE, recorded_gait.load(name).stance_end)[:, 1]
        assert np.sqrt(np.mean((ours - share) ** 2)) < most, name


def test_load_begins_and_ends_without_a_jerk() -> None:
    phase = np.linspace(0.0, 0.65, 1301)
    slope = np.gradient(loaded(phase, 0.65), phase)
    assert slope[0] < 0.5 and abs(slope[-1]) < 0.5
    assert np.abs(np.diff(slope)).max() < 0.05 * np.abs(slope).max()
    assert loaded(np.array([0.15, 0.3, 0.5]), 0.65) == pytest.approx([1.0, 1.0, 1.0])


def test_the_centre_stays_in_the_sole_and_moves_smoothly() -> None:
    centre = pressure_centres(PHASE, (PHASE + 0.5) % 1.0, 0.65, PERSON)
    assert centre.min() >= PERSON.heel and centre.max() <= PERSON.toe + TOES
    stance = np.linspace(0.0, 1.0, 2001)
    speed = np.gradient(pressure_course(stance), stance)
    assert speed.min() > 0.0  # never back
    assert np.abs(np.diff(speed)).max() < 0.05
