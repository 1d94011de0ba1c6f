"""A whole trial walked as it is: every stride its own, the foot on the ground at rest, the sums those of its strides."""

import numpy as np
import pytest

from exo_sim.errors import ScenarioError
from exo_sim.gait import own_gait, recorded_gait, scenario_file, whole_trial
from exo_sim.gait.motion import SAMPLES, derivatives
from exo_sim.gait.own_gait import GaitFile
from exo_sim.gait.walking import walking_as
from exo_sim.machine.person import Person, leg_points

PERIOD = 1.05


def write(path, uneven, seconds=7.2, bend=1.0, drop=None):
    """Write a walk as CSV in degrees: strides of uneven length, the left knee bent by a factor; rows from `drop` on are left out."""
    gait, spread = recorded_gait.load("falisse"), np.random.default_rng(3).standard_normal(12)
    strikes = np.concatenate([[0.0], np.cumsum(PERIOD * (1.0 + uneven * spread))]) - 0.4
    time = np.arange(0.0, seconds, 0.01)
    phase = np.interp(time, strikes, np.arange(len(strikes)))
    columns = {"torso_pitch.position [deg]": gait.recorded["tilt"](phase)}
    for side, late in (("r", 0.0), ("l", 0.5)):
        own = phase - late
        columns[f"hip_{side}.position [deg]"] = gait.recorded["thigh"](own) - gait.recorded["tilt"](own)
        columns[f"knee_{side}.position [deg]"] = gait.recorded["knee"](own) * (bend if side == "l" else 1.0)
        columns[f"ankle_{side}.position [deg]"] = gait.recorded["ankle"](own)
    rows = [[t, *(np.degrees(c[i]) for c in columns.values())] for i, t in enumerate(time)]
    kept = [row for row in rows if drop is None or not drop[0] < row[0] < drop[1]]
    path.write_text(",".join(["time [s]", *columns]) + "\n" + "\n".join(",".join(f"{v:.6f}" for v in row) for row in kept) + "\n")
    return path, strikes[(strikes > 0) & (strikes < seconds)]


@pytest.fixture(scope="module")
def uneven(tmp_path_factory):
    path, strikes = write(tmp_path_factory.mktemp("gait") / "uneven.csv", uneven=0.03, bend=0.9)
    return whole_trial.motion(own_gait.whole_of(GaitFile(path, whole=True))[0], Person()), strikes


def test_of_strides_that_are_all_alike_every_one_is_the_mean_stride(tmp_path):
    path, _ = write(tmp_path / "even.csv", uneven=0.0)
    part, remarks = own_gait.whole_of(GaitFile(path, whole=True))
    motion, mean = whole_trial.motion(part, Person()), walking_as(part.figures, Person())
    assert f"{motion.strides} strides from" in remarks[-1] and "as they are" in remarks[-1]
    assert motion.strides >= 5
    assert motion.stride_time == pytest.approx(PERIOD, rel=2e-3)
    assert motion.advance == pytest.approx(motion.strides * mean.advance, rel=0.02)
    shift = round(part.foot_phase[0, 1] % 1.0 * SAMPLES)  # a left foot may lead
    wanted = np.roll(np.tile(mean.position, (motion.strides, 1)), -shift, axis=0)
    middle = slice(SAMPLES, -SAMPLES)
    assert np.abs(motion.position - wanted)[middle, 2:].max() < np.radians(1.5)
    assert np.abs(motion.position - wanted)[middle, 1].max() < 0.004


def test_every_stride_takes_as_long_as_it_took(uneven):
    motion, strikes = uneven
    begins = np.flatnonzero(np.diff(np.floor(motion.trial.foot_phase[:, 1] + 1e-9)) > 0) + 1
    lengths = np.diff(begins) * motion.period / len(motion.position)
    inside = np.diff(strikes)
    assert len(lengths) >= 4
    # by the angles a heel strike is found within two samples of the file
    assert min(np.abs(inside[i : i + len(lengths)] - lengths).max() for i in range(len(inside) - len(lengths) + 1)) < 0.025


def test_a_knee_that_bends_less_stays_so(uneven):
    motion, _ = uneven
    left, right = motion.position[:, 4].min(), motion.position[:, 7].min()
    assert left / right == pytest.approx(0.9, abs=0.03)


def test_the_foot_that_carries_neither_sinks_nor_slides(uneven):
    motion, _ = uneven
    rate = motion.period
    x = motion.position[:, 0] + motion.advance * np.arange(len(motion.position)) / len(motion.position)
    for i, first in enumerate((3, 6)):
        thigh = motion.position[:, 2] + motion.position[:, first]
        point = leg_points(thigh, motion.position[:, first + 1], motion.position[:, first + 2], Person())
        phase = motion.trial.foot_phase[:, i] % 1.0
        flat = (phase > 0.2) & (phase < 0.34)
        height = motion.position[:, 1] + point["heel"][:, 1]
        assert np.abs(height[flat]).max() < 0.012
        speed = (motion.slope[:, 0] + derivatives(point["heel"])[0][:, 0]) / rate
        assert np.abs(speed[flat]).mean() < 0.12  # m/s; the pelvis goes at 1.2
    assert x[-1] > 5.0


def test_a_cycle_closes_smoothly(uneven):
    motion, _ = uneven
    steps = np.abs(np.diff(np.concatenate([motion.position, motion.position[:1]]), axis=0))
    assert (steps[-1] <= 1.05 * steps[:-1].max(axis=0)).all()
    assert np.isfinite(motion.curvature).all()


def test_torques_planned_on_the_mean_stride_are_played_at_each_strides_phase(uneven):
    motion, _ = uneven
    grid = np.arange(SAMPLES + 1) / SAMPLES
    table = np.stack([np.cos(2 * np.pi * (grid + (0.5 if j < 3 else 0.0))) for j in range(6)], axis=1)
    played = motion.trial.played(table)
    assert played.shape == (len(motion.position) + 1, 6)
    for side, columns in ((0, slice(0, 3)), (1, slice(3, 6))):  # each leg sees the same of its own phase
        wanted = np.cos(2 * np.pi * motion.trial.foot_phase[:, side])
        assert np.abs(played[:-1, columns] - wanted[:, None]).max() < 1e-3


def test_what_belongs_to_segments_goes_by_their_own_foot(uneven):
    motion, _ = uneven
    grid = np.arange(SAMPLES) / SAMPLES
    table = np.stack([np.cos(2 * np.pi * (grid + (0.5 if 0 < j < 4 else 0.0))) for j in range(7)], axis=1)
    found = motion.trial.of_segments(table[:, :, None])
    assert found.shape == (len(motion.position), 7, 1)
    for side, rows in ((0, [1, 2, 3]), (1, [0, 4, 5, 6])):
        wanted = np.cos(2 * np.pi * motion.trial.foot_phase[:, side])
        assert np.abs(found[:, rows, 0] - wanted[:, None]).max() < 1e-3


def test_a_gap_ends_the_run_of_strides(tmp_path):
    path, _ = write(tmp_path / "gap.csv", uneven=0.0, drop=(5.0, 5.5))
    part, _ = own_gait.whole_of(GaitFile(path, whole=True))
    assert part.stop < 5.2
    assert part.strides in (3, 4)


def test_a_scenario_file_may_ask_for_the_whole(tmp_path):
    write(tmp_path / "walk.csv", uneven=0.02)
    (tmp_path / "mine.toml").write_text('[gait]\nfile = "walk.csv"\nwhole = true\n')
    found = scenario_file.read(tmp_path / "mine.toml")
    assert found.cycle == "trial" and found.cycles == 1
    assert found.motion(Person()).strides > 3
    (tmp_path / "mine.toml").write_text('[gait]\nfile = "walk.csv"\nwhole = 3\n')
    with pytest.raises(ScenarioError, match=r"gait\.whole = 3: write true or false"):
        scenario_file.read(tmp_path / "mine.toml")


@pytest.mark.slow
def test_a_whole_trial_is_simulated_and_its_books_close(tmp_path):
    import exo_sim as exo

    path, _ = write(tmp_path / "walk.csv", uneven=0.02, seconds=3.9)
    run = exo.simulate(gait=path, whole=True, assist="vented", payload="10 kg")
    phase = run.recording["gait.phase"]
    strides = len(np.flatnonzero(np.diff(phase) < -0.5)) + (phase[-1] > 0.5)
    assert strides in (2, 3)
    assert run.summary["simulated_s"] == pytest.approx(strides * PERIOD, rel=0.05)
    assert abs(run.summary["ledger"]["closure"]) < 1.0
    carried = run.summary["mean_ground_force_n"] + run.summary["strap_load_n"]["vertical_mean"]
    assert carried == pytest.approx(run.summary["supported_weight_n"], rel=0.1)
    with pytest.raises(ScenarioError, match="name the gait"):
        exo.simulate(scenario="level_walk", whole=True)
