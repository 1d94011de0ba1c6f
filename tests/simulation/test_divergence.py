"""Rows that cannot be, each refused by its own sentence."""

from typing import Any, cast

import mujoco
import numpy as np
import pytest

from exo_sim.errors import Diverged
from exo_sim.simulation.divergence import WearerWatch, check_numbers, check_strokes

PERIOD, ADVANCE, STEP = 2.0, 1.0, 0.1
MODEL = mujoco.MjModel.from_xml_string("<mujoco><worldbody/></mujoco>")
KEYS = ("time", "torso_x.position", "torso_z.position", "torso_pitch.position")


class Upright:
    """A wearer that goes ahead evenly, upright, 1 m high."""

    period, advance, climb = PERIOD, ADVANCE, 0.0
    position = np.tile([0.0, 1.0, 0.0], (8, 1))

    def at(self, cycles, columns):
        return np.tile([0.0, 1.0, 0.0], (len(cycles), 1))


def watch():
    return WearerWatch("stroll", mujoco.MjData(MODEL), cast(Any, Upright()), STEP, KEYS)


def rows(start, count):
    time = (start + np.arange(count)) * STEP
    return np.stack([time, ADVANCE * time / PERIOD, np.ones(count), np.zeros(count)], axis=1)


@pytest.mark.parametrize(("x", "says"), [(0.16 + 0.17, "170 mm outside"), (-1e4, r"1e\+07 mm outside its stroke of 160 mm by 3 s; slower")])
def test_a_piston_far_outside_its_cylinder_is_refused(x, says):
    lengths = np.array([[0.0], [0.16], [-0.1], [0.3]])
    check_strokes(lengths, ["piston.length"], {"piston": 0.16}, "swing", "by 3 s", "slower")
    with pytest.raises(Diverged, match="swing: the piston of piston is .*" + says):
        check_strokes(np.vstack([lengths, [[x]]]), ["piston.length"], {"piston": 0.16}, "swing", "by 3 s", "slower")


def test_a_machine_that_keeps_to_its_wearer_passes():
    watch().check(rows(30, 10), 30)
    assert watch().sound(rows(39, 1)[0], 39)


@pytest.mark.parametrize(("column", "off", "passes"), [(1, 0.3, True), (1, 0.4, False), (2, -0.4, False), (3, 0.6, True), (3, -0.8, False)])
def test_a_fall_is_one_beyond_distance_or_pitch(column, off, passes):
    fallen = rows(30, 10)
    fallen[-1, column] += off
    assert watch().sound(fallen[-1], 39) == passes
    if passes:
        watch().check(fallen, 30)
    else:
        with pytest.raises(Diverged, match=r"stroll: the machine falls away .* at 3\.000 to 4\.000 s"):
            watch().check(fallen, 30)


def test_a_number_that_is_none_is_named():
    broken = rows(0, 5)
    broken[3, 2] = np.nan
    assert not watch().sound(broken[3], 3)
    with pytest.raises(Diverged, match=r"torso_z\.position is not a number"):
        watch().check(broken, 0)


def test_a_warning_of_mujoco_is_named():
    data = mujoco.MjData(MODEL)
    data.warning.number[int(mujoco.mjtWarning.mjWARN_BADQACC)] = 1
    with pytest.raises(Diverged, match="lift: MuJoCo warns of mjWARN_BADQACC soon; stop"):
        check_numbers(data, np.zeros((1, 1)), ["time"], "lift", "soon", "stop")
