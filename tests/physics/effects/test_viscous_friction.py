"""Known limits of viscous friction: closed forms and published numbers."""

from __future__ import annotations

import math

import pytest
from physics.sliding import contact, nothing, slide, steady_resistance


def test_speed_fades_exponentially() -> None:
    found = slide(contact(viscous_friction={"coefficient": 40.0}), 10.0, 0.5, nothing, 0.5, 1e-5)
    assert found[-1, 1] == pytest.approx(0.5 * math.exp(-2.0), rel=5e-5)


def test_a_film_that_thins_with_shear_resists_with_a_power_of_speed_and_as_told_at_a_tenth_of_a_metre_a_second() -> None:
    film = contact(viscous_friction={"coefficient": 40.0, "index": 0.8})
    plain = contact(viscous_friction={"coefficient": 40.0})
    for speed in (0.01, 0.1, 0.7):
        assert steady_resistance(film, speed) == pytest.approx(40.0 * 0.1 * (speed / 0.1) ** 0.8, rel=1e-12)
        assert steady_resistance(film, -speed) == -steady_resistance(film, speed)
    assert steady_resistance(film, 0.1) == pytest.approx(steady_resistance(plain, 0.1), rel=1e-12)
    assert steady_resistance(film, 1e-7) / 1e-7 == pytest.approx(40.0 * 0.01**-0.2, rel=1e-12)  # a slope that ends


def test_speed_fades_as_a_film_with_a_power_of_a_half_says() -> None:
    """dv/dt = -a v^(1/2), so sqrt(v) falls in proportion to time."""
    strength = 40.0 * 0.1**0.5  # N (s/m)^(1/2)
    found = slide(contact(viscous_friction={"coefficient": 40.0, "index": 0.5}), 10.0, 0.5, nothing, 0.4, 1e-5)
    assert found[-1, 1] == pytest.approx((math.sqrt(0.5) - 0.5 * strength / 10.0 * 0.4) ** 2, rel=1e-4)
