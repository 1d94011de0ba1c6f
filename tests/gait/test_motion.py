"""Reference motions: smooth, periodic, standing on the ground, and inside what was recorded."""

import importlib.machinery
import importlib.util

import numpy as np
import pytest

from exo_sim.errors import ScenarioError
from exo_sim.gait import recorded_gait, scenario
from exo_sim.gait.motion import SAMPLES, derivatives, look_up, reference
from exo_sim.machine.person import Person, leg_points

WALKS = ("level_walk", "level_walk_opensim")


def test_the_list_prints_itself():
    assert {"level_walk", "level_walk_opensim", "squat", "sit_to_stand", "stand", "payload_step"} <= set(
        scenario.names()
    )
    for name in scenario.names():
        assert scenario.find(name).summary


def test_a_misspelt_scenario_is_answered_with_the_nearest():
    with pytest.raises(ScenarioError, match='did you mean "level_walk"'):
        scenario.find("level_wlak")
    with pytest.raises(ScenarioError, match=r"0\.7 to 1\.3"):
        scenario.motion("level_walk", Person(), 2.0)


@pytest.mark.parametrize("name", scenario.names())
def test_positions_and_rates_belong_together(name):
    motion = scenario.motion(name, Person(), 1.0)
    position, slope = motion.tables()
    q, v, after, before = np.empty(9), np.empty(9), np.empty(9), np.empty(9)
    h = 1e-5
    for cycles in (0.0, 0.3712, 2.5, 7.999):
        reference(cycles, motion.period, motion.advance, motion.climb, position, slope, q, v)
        reference(cycles + h, motion.period, motion.advance, motion.climb, position, slope, after, v)
        reference(cycles - h, motion.period, motion.advance, motion.climb, position, slope, before, v)
        reference(cycles, motion.period, motion.advance, motion.climb, position, slope, q, v)
        np.testing.assert_allclose((after - before) / (2 * h * motion.period), v, atol=2e-3)
        steady = (np.eye(9)[0] * motion.advance + np.eye(9)[1] * motion.climb) * cycles
        np.testing.assert_allclose(q - steady, motion.at(np.array([cycles]))[0], atol=5e-4)
    first, second = derivatives(motion.position)
    first[:, 0] += motion.advance
    first[:, 1] += motion.climb
    np.testing.assert_allclose(first, motion.slope, atol=1e-9)
    np.testing.assert_allclose(second, motion.curvature, atol=1e-6)


@pytest.mark.parametrize("name", scenario.names())
@pytest.mark.parametrize("height", [1.55, 1.70, 1.90])
def test_a_standing_foot_neither_floats_nor_sinks_nor_slides(name, height):
    person = Person(height)
    motion = scenario.motion(name, person, 1.0)
    q = np.tile(motion.position, (2, 1))
    cycles = np.arange(len(q)) / len(motion.position)
    q[:, 0] += motion.advance * cycles
    q[:, 1] += motion.climb * cycles
    for leg, first in ((0, 3), (1, 6)):
        points = leg_points(q[:, 2] + q[:, first], q[:, first + 1], q[:, first + 2], person)
        for k, tip in enumerate(("heel", "toe")):
            down = np.tile(motion.contact[:, 2 * leg + k], 2)
            at = points[tip] + q[:, :2]
            at[:, 1] -= [motion.ground.height(x) for x in at[:, 0]]
            assert at[:, 1].min() > -3e-3
            lands = int(np.argmax(down[1:] & ~down[:-1])) + 1 if not down.all() else 0
            lasts = int(np.argmin(down[lands:])) if not down.all() else len(down)
            stands = at[lands + 15 : lands + lasts - 15]  # landing and lifting left out
            assert len(stands) > 80
            assert np.abs(stands[:, 1]).max() < 4e-3
            assert np.ptp(stands[:, 0]) < 6e-3


@pytest.mark.parametrize("name", WALKS)
def test_a_walk_stays_within_two_standard_deviations_of_the_recording(name):
    gait = recorded_gait.load(scenario.find(name).gait)
    phase = np.arange(100) / 100
    for angle in ("thigh", "knee", "ankle"):
        offset = gait.ankle_offset if angle == "ankle" else 0.0
        error = gait.motion[angle](phase) - gait.recorded[angle](phase) - offset
        assert np.abs(error / np.maximum(gait.spread[angle](phase), np.radians(0.8))).max() < 2.0


def test_left_and_right_are_half_a_stride_apart():
    motion = scenario.motion("level_walk", Person(), 1.0)
    np.testing.assert_allclose(
        motion.position[:, 3:6], np.roll(motion.position[:, 6:9], SAMPLES // 2, axis=0), atol=1e-9
    )
    np.testing.assert_allclose(motion.share.sum(axis=1), 1.0)


def test_cadence_changes_time_only():
    slow, fast = (scenario.motion("level_walk", Person(), speed) for speed in (0.7, 1.3))
    assert slow.period / fast.period == pytest.approx(1.3 / 0.7)
    np.testing.assert_array_equal(slow.position, fast.position)


def test_a_table_is_looked_up_between_its_rows():
    out = np.empty(2)
    table = np.array([[0.0, 1.0], [1.0, 3.0], [0.0, 1.0]])
    look_up(3.25, table, out)
    np.testing.assert_allclose(out, [0.5, 2.0])


@pytest.mark.real_data
def test_the_committed_figures_are_those_of_the_recordings(shared_data, repository, tmp_path):
    loader = importlib.machinery.SourceFileLoader("fit_gait", str(repository / "scripts" / "fit_gait"))
    spec = importlib.util.spec_from_loader("fit_gait", loader)
    assert spec is not None
    script = importlib.util.module_from_spec(spec)
    loader.exec_module(script)
    for name, read in (("falisse", script.falisse), ("opensim", script.opensim)):
        script.write(tmp_path / f"{name}.toml", read(shared_data))
        again = recorded_gait.parse((tmp_path / f"{name}.toml").read_text())
        kept = recorded_gait.load(name)
        assert again.period == pytest.approx(kept.period, abs=1e-4)
        phase = np.arange(50) / 50
        for group in ("motion", "recorded", "spread", "moment"):
            for key, series in getattr(kept, group).items():
                np.testing.assert_allclose(getattr(again, group)[key](phase), series(phase), atol=2e-3, err_msg=key)
