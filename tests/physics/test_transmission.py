"""Between piston and joint: springs in series, gaps that play, and a piston that rests where its forces balance."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.physics.effects.backlash import CONTACT_STIFFNESS
from exo_sim.physics.pneumatics import paper_cylinder, paper_world
from exo_sim.physics.transmission import carried, gives, piston_at, play, stiffness


def cylinder(mount: float = 0.0, drive: float = 0.0, gap: float = 0.0, arm: float = 1.0) -> np.ndarray:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6, 1e-5, 1e-5)
    c["transmission_compliance"]["stiffness"], c["drive_stiffness"], c["backlash"]["gap"], c["arm"] = mount, drive, gap, arm
    return c


@pytest.mark.parametrize(("mount", "drive", "gap", "soft"), [(0.0, 0.0, 0.0, False), (1e5, 0.0, 0.0, True), (0.0, 500.0, 0.0, True),
                                                             (0.0, 0.0, 1e-3, True)])  # fmt: skip
def test_it_gives_where_anything_between_them_does(mount: float, drive: float, gap: float, soft: bool) -> None:
    assert gives(cylinder(mount, drive, gap)[0]) is soft


def test_mount_and_drive_are_springs_in_series_by_the_square_of_the_lever() -> None:
    assert stiffness(cylinder(1e5)[0]) == pytest.approx(1e5)
    at_rod = 500.0 / 0.05**2
    assert stiffness(cylinder(1e5, 500.0, arm=0.05)[0]) == pytest.approx(1.0 / (1e-5 + 1.0 / at_rod))
    assert stiffness(cylinder(gap=1e-3)[0]) == CONTACT_STIFFNESS


def test_a_gap_carries_nothing_until_it_is_taken_up() -> None:
    c = cylinder(1e5, gap=2e-3)[0]
    assert play(c, 0.9e-3) == 0.0 and carried(c, 0.0509, 0.05) == 0.0
    assert carried(c, 0.052, 0.05) == pytest.approx(1e5 * 1e-3) and carried(c, 0.048, 0.05) == pytest.approx(-1e5 * 1e-3)


def test_the_piston_rests_where_gas_and_mount_balance() -> None:
    c, world = cylinder(2e5), paper_world()
    p_1, p_2, x = 5e5, 3e5, 0.05
    where = piston_at(world[0], c[0], p_1, p_2, x, x, 0.0, 0.0, 1e-3)
    v_1, v_2 = 1e-5 + c["area_1"][0] * x, 1e-5 + c["area_2"][0] * (0.1 - x)
    moved = where - x
    q_1 = p_1 * (v_1 / (v_1 + c["area_1"][0] * moved)) ** 1.4
    q_2 = p_2 * (v_2 / (v_2 - c["area_2"][0] * moved)) ** 1.4
    push = q_1 * c["area_1"][0] - q_2 * c["area_2"][0] - 101325.0 * (c["area_1"][0] - c["area_2"][0])
    assert moved > 0.0 and push == pytest.approx(2e5 * moved, rel=1e-6)
