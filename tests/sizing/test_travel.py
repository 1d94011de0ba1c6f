"""Stops for the tasks alone: inside the MJCF's own, around what the motions ask of either side, and shorter strokes with them."""

import numpy as np
import pytest

from exo_sim.sizing.design import spring_mass
from exo_sim.sizing.joint_kinds import kinds_of
from exo_sim.sizing.travel import BEYOND, within_tasks


def test_stops_lie_ten_degrees_outside_what_the_tasks_ask_for(exo, loads):
    machine = within_tasks(exo, (loads,))
    whole, short = ({kind.name: kind for kind in kinds_of(rig)} for rig in (exo, machine))
    for name in ("hip", "knee"):
        both = np.concatenate([loads.column(f"{name}_{side}")[0] for side in "lr"])
        low, high = whole[name].range
        assert short[name].range == pytest.approx((max(both.min() - BEYOND, low), min(both.max() + BEYOND, high)))
        travel = [np.ptp(kinds[name].sweep(kinds[name].own)[0]) for kinds in (whole, short)]
        assert travel[1] < travel[0]


def test_a_springs_mass_is_what_it_stores_at_the_farther_end_of_the_stroke():
    assert spring_mass(None, 0.1) == 0.0
    assert spring_mass((3e3, 0.0), 0.1) == pytest.approx(0.5 * 3e3 * 0.01 / 150.0)
    assert spring_mass((3e3, 0.3), 0.1) == pytest.approx(0.5 * 3e3 * 0.09 / 150.0)
