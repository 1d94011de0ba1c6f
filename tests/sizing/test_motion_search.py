"""Sizing along a motion: what the rods must do is Newton's law, and the recommended design does it."""

from dataclasses import replace

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import RigError, ScenarioError
from exo_sim.machine.rig_model import load
from exo_sim.recording.table import Recording
from exo_sim.sizing import motion_result
from exo_sim.sizing.motion_loads import rod_loads
from exo_sim.sizing.motion_search import RodJudge, front_of
from exo_sim.sizing.rod_space import rod_space

TIME = np.arange(0.0, 1.2, 0.01)
OMEGA, MIDDLE, SWING = 2 * np.pi, 0.08, 0.03


@pytest.fixture(scope="module")
def bench(repository):
    return rigs.read(repository / "assets" / "bench.toml")


@pytest.fixture(scope="module")
def motion():
    columns = {"slide.position": MIDDLE + SWING * np.sin(OMEGA * TIME), "slide.external_force": np.full(len(TIME), -200.0)}
    return Recording("motion.csv", TIME, columns, {"slide.position": "m", "slide.external_force": "N"}, {})


@pytest.fixture(scope="module")
def judge(bench, motion):
    return RodJudge(bench, motion, rod_space(bench, None, (), None, {}), rod_loads(bench, motion))


def test_a_rod_must_accelerate_the_mass_and_hold_against_what_acts_from_outside(bench, judge):
    loads = judge.loads
    model = load(bench)
    body = int(model.jnt_bodyid[model.joint("slide").id])
    mass = float(model.body_subtreemass[body])
    x = loads.length[:, 0]
    inner = slice(30, -30)  # smoothing knows nothing of what is beyond the ends
    acceleration = -(OMEGA**2) * (x - MIDDLE)
    damping = float(np.ravel(model.dof_damping)[model.joint("slide").dofadr[0]])
    wanted = mass * acceleration + damping * loads.speed[:, 0] + 200.0
    assert loads.force[inner, 0] == pytest.approx(wanted[inner], abs=0.02 * np.abs(wanted).max())
    assert loads.span[0] == pytest.approx([0.0, 0.16])


def test_designs_are_judged_by_following_the_motion_and_the_chosen_one_is_written(judge, motion, tmp_path):
    numbers = {"supply": 7e5, "piston.above": 0, "piston.valve": 8e-6}
    good, weak = judge.judge(numbers, 0), judge.judge({**numbers, "supply": 4.1e5, "piston.above": 0}, 1)
    assert good.fate == ""
    assert good.margin >= 0.25
    assert good.position_error < 1e-3
    assert good.gas > 0.0
    assert weak.rig.cylinders["piston"].bore >= good.rig.cylinders["piston"].bore  # less pressure, no smaller piston
    found = motion_result.result(judge, [good, weak])
    path = motion_result.write(found, tmp_path)
    again = rigs.read(path)
    assert again.cylinders["piston"].bore == pytest.approx(found.chosen.rig.cylinders["piston"].bore)
    assert again.cylinders["piston"].stroke >= 0.16
    assert motion_result.numbers(found, tmp_path)["pareto"][0]["supply_pa"] > 0.0
    assert "over the motion" in motion_result.words(found, tmp_path)


def test_what_cannot_be_had_says_why(bench, motion, judge):
    with pytest.raises(ScenarioError, match=r"--fix piston.bore: the catalogue has no bore of 41 mm"):
        rod_space(bench, None, (), None, {"piston.bore": 0.041})
    with pytest.raises(ScenarioError, match=r"--joints: no cylinder of .* drives \"slied\""):
        rod_space(bench, None, ("slied",), None, {})
    with pytest.raises(RigError, match="leaves nothing to choose"):
        rod_space(bench, 2e5, (), None, {})
    tiny = RodJudge(bench, motion, replace(judge.space, fixed={"piston.bore": 0.008}), judge.loads)
    lost = tiny.judge({"supply": 7e5, "piston.above": 0, "piston.valve": 8e-6}, 0)
    assert lost.fate != ""
    assert front_of([lost]) == []
    with pytest.raises(ScenarioError, match="none of 1 designs does it"):
        motion_result.result(tiny, [lost])
