"""A machine on a wearer who is a body: residual, ledger, straps that only pull, and what is refused."""

import numpy as np
import pytest

import exo_sim as exo
from exo_sim import rig as rigs
from exo_sim.errors import ScenarioError
from exo_sim.gait.variation import Variation
from exo_sim.simulation import record
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.torque_driven_wearer import expect
from exo_sim.simulation.walk import Request, rig_at_250_psi
from exo_sim.simulation.worn import Simulation


@pytest.fixture(scope="module")
def walk():
    return Simulation(rigs.read(rig_at_250_psi()), Request("level_walk", 34.0, cycles=6, rehearsals=3, wearer="torques")).run()


@pytest.fixture(scope="module")
def summary(walk):
    return summarise(walk)


def test_the_residual_is_within_the_published_guideline_in_all_three(summary):
    columns = [summary["wearer"], summary["compared_with"]["no_machine"], summary["compared_with"]["backpack"]]
    for residual in (column["pelvis_residual"] for column in columns):
        assert residual["force_peak_n"] < 25.0 and residual["force_rms_n"] < 10.0
        assert residual["moment_peak_nm"] < 75.0 and residual["moment_rms_nm"] < 50.0
    assert all(column["pressure_centre_outside_share"] == 0.0 for column in columns)


def test_the_ledger_closes(summary):
    ledger = summary["ledger"]
    assert abs(ledger["closure"]) < 1.0
    assert ledger["soles"] < 0.0
    assert ledger["wearer_joints"]["ankle"][0] > 10.0


def test_he_yields_to_the_straps(walk):
    from exo_sim.simulation.loop import person_along

    prescribed = person_along(walk.time, walk.motion, walk.person)
    off = np.abs(walk.poses - prescribed)[:, :, :3]
    assert 1e-3 < off[:, 0, :2].max() < 0.1
    assert off[:, 1:, 2].max() > np.radians(0.5)


def test_shoulder_straps_do_not_lift_the_wearer(walk):
    pitch = walk.poses[:, 0, 2]
    ahead, up = (walk.columns[f"torso_strap_high.strap_force_{axis}"] for axis in "xz")
    along = -np.sin(pitch) * ahead + np.cos(pitch) * up
    assert along.min() > -1e-6 and along.max() > 5.0


def test_the_recording_shows_his_bodies(walk):
    scene = record.scene(walk)
    feet = [i for i, body in enumerate(scene.bodies) if body.startswith("person_foot")]
    assert len(feet) == 2
    heights = scene.positions[:, feet, 2]
    assert heights.min() > 0.03 and np.ptp(heights) > 0.1


def test_what_is_written_has_his_joints_and_forces(tmp_path):
    run = exo.simulate(scenario="level_walk", strides=3, demand="inverse_dynamics", wearer="torques", out=tmp_path / "walk.rrd")
    assert run.table is not None
    recording = exo.Recording.load(run.table)
    for key in ("wearer_knee_l.position", "hip_r.wearer_total_moment", "foot_l.wearer_force_z", "ledger.residual_moment"):
        assert np.isfinite(recording[key]).all(), key
    assert run.summary["compared_with"]["backpack"]["wearer_joints"]["hip"][0] > 0.0


def test_nobody_sits_without_a_chair():
    with pytest.raises(ScenarioError, match="no chair"):
        Simulation(rigs.read(rig_at_250_psi()), Request("sit_to_stand", 10.0, rehearsals=0, wearer="torques"))


def test_a_wearer_of_another_kind_is_refused():
    with pytest.raises(ScenarioError, match="prescribed"):
        Request("level_walk", wearer="prescribe")


def test_a_scenario_file_may_say_it(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('like = "level_walk"\nwearer = "torques"\n')
    assert Request(str(path)).moved_by == "torques" and Request(str(path), wearer="prescribed").moved_by == "prescribed"
    path.write_text('like = "level_walk"\nwearer = "torque"\n')
    with pytest.raises(ScenarioError, match="torques"):
        Request(str(path))


def test_he_hardly_pulls_the_machine(walk, summary):
    """He pulled it ahead with 27 N where rehearsals went by feet that stay where they are planned; what holds his pelvis grows little."""
    assert abs(summary["wearer"]["forward_push_n"]) < 23.0
    ahead = walk.moved.ground.residual[:, 0]
    assert abs(ahead.mean()) < 10.0


def test_what_he_expects_of_straps_changes_what_he_plans() -> None:
    """Where it is what he expected already nothing changes; a load on the trunk is carried by the leg that stands."""
    it = Simulation(rigs.read(rig_at_250_psi()), Request("level_walk", 34.0, cycles=2, rehearsals=0, wearer="torques"))
    planned, at_rest = it.torques, it.motion.position
    assert planned is not None
    expect(it, it.expected)
    assert it.torques is not None
    np.testing.assert_allclose(it.torques, planned)
    more = it.expected.copy()
    more[:, 0, 1] -= 100.0
    expect(it, more)
    changed = np.abs(it.torques - planned)[:, :6].max(axis=1)
    assert changed.min() > 0.5 and changed.max() < 60.0
    assert it.motion.position[:, 1].mean() < at_rest[:, 1].mean()  # soles are pressed deeper


def test_a_step_that_takes_longer_does_not_make_him_stumble() -> None:
    """His foot was put back to where the reference has it, also where he fell behind it: 38 N held him then."""
    uneven = Variation(asymmetry=0.05)
    request = Request("level_walk", 34.0, cycles=8, rehearsals=3, wearer="torques", variation=uneven)
    moved = Simulation(rigs.read(rig_at_250_psi()), request).run().moved
    assert moved is not None
    residual = moved.ground.residual
    assert np.hypot(residual[:, 0], residual[:, 1])[2500:].max() < 25.0


@pytest.mark.slow
def test_he_starts_and_stops_again_and_again() -> None:
    """With a demand as fast as for one who walks on he fell in his second walk; until the soles were soft at first, in his fourth."""
    found = summarise(Simulation(rigs.read(rig_at_250_psi()), Request("start_and_stop", 34.0, cycles=5, wearer="torques")).run())
    assert found["wearer"]["pelvis_residual"]["force_peak_n"] < 30.0
    assert found["wearer"]["pressure_centre_outside_share"] == 0.0 and abs(found["ledger"]["closure"]) < 1.0
