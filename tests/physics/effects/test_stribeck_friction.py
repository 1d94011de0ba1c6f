"""Known limits of stribeck friction: closed forms and published numbers."""

from __future__ import annotations

import math

import pytest
from physics.sliding import LUGRE, LUGRE_TABLE, contact, steady_resistance


def test_steady_friction_follows_the_stribeck_curve() -> None:
    joint = contact(**LUGRE)
    for v, force in LUGRE_TABLE:
        assert steady_resistance(joint, v) == pytest.approx(force, abs=2e-9)
        assert steady_resistance(joint, -v) == pytest.approx(-force, abs=2e-9)


def test_excess_falls_with_its_exponent() -> None:
    """At the Stribeck velocity a part 1/e of the excess is left, whatever the exponent; at four times that exp(-4^exponent)."""
    for exponent in (0.5, 1.0, 1.5, 2.0):
        dip = {**LUGRE["stribeck_friction"], "exponent": exponent}
        joint = contact(coulomb_friction={"force": 15.0}, stribeck_friction=dip)
        for times in (1.0, 4.0):
            excess = 10.0 * math.exp(-(times**exponent))
            assert steady_resistance(joint, 0.02 * times) == pytest.approx(15.0 + excess, abs=1e-8)
    assert steady_resistance(contact(**LUGRE), 0.031) == pytest.approx(
        steady_resistance(contact(**{**LUGRE, "stribeck_friction": {**LUGRE["stribeck_friction"], "exponent": 2.0}}), 0.031), rel=1e-14
    )


def test_excess_falls_with_its_tail_from_an_exponential_to_a_lorentzian() -> None:
    """With s = (v/velocity)^exponent: exp(-s) as the tail vanishes, (1 + s/2)^-2 with half of one, 1/(1 + s) with a whole one."""
    for exponent in (0.7, 2.0):
        for times in (0.5, 1.0, 6.0):
            s = times**exponent
            for tail, left in ((1e-9, math.exp(-s)), (0.5, (1.0 + 0.5 * s) ** -2.0), (1.0, 1.0 / (1.0 + s))):
                dip = {**LUGRE["stribeck_friction"], "exponent": exponent, "tail": tail}
                joint = contact(coulomb_friction={"force": 15.0}, stribeck_friction=dip)
                assert steady_resistance(joint, 0.02 * times) == pytest.approx(15.0 + 10.0 * left, abs=2e-6)
