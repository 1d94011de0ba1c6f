"""Metabolic power against its own limits and the published equation of soldiers."""

from __future__ import annotations

import pytest

from exo_sim.machine.metabolism import STANDING, power, published


def test_who_does_no_work_costs_what_standing_costs() -> None:
    still = power(0.0, 0.0, 75.0)
    assert (still.value, still.low, still.high) == (STANDING * 75.0,) * 3


def test_work_given_costs_four_times_itself_and_work_taken_less_than_itself() -> None:
    """The upper bound counts all work: 100 W given and 60 W taken are 400 and 50 W of food."""
    walking = power(100.0, -60.0, 75.0)
    assert walking.high - STANDING * 75.0 == pytest.approx(400.0 + 50.0)
    assert walking.low - STANDING * 75.0 == pytest.approx(0.4 * 450.0)
    assert walking.value == pytest.approx(0.5 * (walking.low + walking.high))
    assert walking.as_json()["low"] == walking.low


@pytest.mark.parametrize(("load", "speed", "watts"), [(0.0, 0.0, 105.0), (0.0, 1.3, 282.45), (35.0, 1.0, 315.0)])
def test_the_equation_of_pandolf(load: float, speed: float, watts: float) -> None:
    """By hand, 70 kg: 1.5 W + 2 (W + L) (L / W)^2 + 1.5 (W + L) v^2."""
    assert published(70.0, load, speed) == pytest.approx(watts)
