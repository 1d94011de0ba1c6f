"""Volumes and rod force of a cylinder against its geometry."""

from __future__ import annotations

import math

import pytest

from exo_sim.physics.cylinder import rod_force, volume_1, volume_2

A_1, A_2 = math.pi * 0.032**2 / 4, math.pi * (0.032**2 - 0.012**2) / 4


@pytest.mark.parametrize("x", [0.0, 0.03, 0.1])
def test_what_one_chamber_gains_the_other_loses_but_for_the_rod(x: float) -> None:
    assert volume_1(x, A_1, 2e-6) == pytest.approx(2e-6 + A_1 * x)
    assert volume_2(x, A_2, 3e-6, 0.1) == pytest.approx(3e-6 + A_2 * (0.1 - x))
    whole = volume_1(x, A_1, 2e-6) + volume_2(x, A_2, 3e-6, 0.1)
    assert whole == pytest.approx(5e-6 + A_2 * 0.1 + math.pi * 0.012**2 / 4 * x)


def test_equal_to_the_atmosphere_on_both_sides_there_is_no_force() -> None:
    assert rod_force(101325.0, 101325.0, A_1, A_2, 101325.0) == pytest.approx(0.0, abs=1e-12)
    assert rod_force(6e5, 101325.0, A_1, A_2, 101325.0) == pytest.approx((6e5 - 101325.0) * A_1)
