"""Known limits of what dry friction depends on beside its level. `test_effects.py` visits them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from physics.effect_limits import LUGRE, contact, limit_of, nothing, slide, steady_resistance

from exo_sim.physics.conditions import Motion
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world
from exo_sim.physics.resistance import dry_level


@limit_of("stribeck_friction")
def excess_falls_with_its_exponent() -> None:
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


@limit_of("pressure_dependent_friction")
def difference_of_pressures_has_an_area_of_its_own() -> None:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6)
    c["pressure_dependent_friction"]["difference"] = 3e-5
    for one, two in ((4e5, 1e5), (1e5, 4e5), (-5e4, 2.5e5)):
        assert dry_level(c[0], Motion(0.0, 0.1, 0.0, one, two)) == pytest.approx(9.0)
    c["pressure_dependent_friction"]["coefficient"] = 2e-5
    assert dry_level(c[0], Motion(0.0, -0.1, 0.0, 4e5, 1e5)) == pytest.approx(10.0 + 9.0)


@limit_of("friction_smoothing")
def creeps_under_a_push_at_the_speed_where_they_balance() -> None:
    """F = Fc tanh(v/v0): a push of half of Coulomb's friction ends at v0 artanh(1/2)."""
    for velocity, dt in ((1e-3, 2.5e-4), (5e-3, 1e-3), (2e-2, 1e-3), (2e-2, 2.5e-4)):
        joint = contact(coulomb_friction={"force": 20.0}, friction_smoothing={"velocity": velocity})
        found = slide(joint, 5.0, 0.0, lambda t, q: 10.0, 1.0, dt)
        rested = found[len(found) // 2 :]
        speed = (rested[-1, 0] - rested[0, 0]) / (dt * (len(rested) - 1))
        assert speed == pytest.approx(velocity * math.atanh(0.5), rel=1e-6)


@limit_of("friction_smoothing")
def sticks_where_the_time_step_does_not_resolve_its_slope() -> None:
    found = slide(contact(coulomb_friction={"force": 20.0}, friction_smoothing={"velocity": 1e-5}), 5.0, 0.0, lambda t, q: 10.0, 5.0, 1e-3)
    assert abs(found[-1, 0]) < 1e-3 and np.abs(found[:, 1]).max() < 1e-2


@limit_of("friction_smoothing")
def slides_like_sharp_friction_far_above_its_velocity() -> None:
    found = slide(contact(coulomb_friction={"force": 20.0}, friction_smoothing={"velocity": 1e-4}), 10.0, 0.3, nothing, 1.0, 1e-4)
    assert found[-1, 0] == pytest.approx(10.0 * 0.3**2 / (2 * 20.0), rel=2e-3)


@limit_of("friction_smoothing")
def creeps_behind_a_soft_mount_as_without_one() -> None:
    """Fc tanh(v/v0) is reached as (Fc/v0)/stiffness goes by, 80 ms."""
    cylinder = paper_cylinder(0.032, 0.012, 0.1, 5e-6, 100.0, 100.0)
    cylinder["coulomb_friction"]["force"], cylinder["friction_smoothing"]["velocity"] = 40.0, 5e-3
    cylinder["transmission_compliance"]["stiffness"] = 1e5
    gas = Pneumatics(paper_world(), cylinder, dt=1e-3)
    a_1, a_2 = cylinder["area_1"][0], cylinder["area_2"][0]
    p_2 = 5e5 * a_1 / a_2 - 101325.0 * (a_1 - a_2) / a_2  # as large a push both ways
    gas.fill(np.array([0.05]), 5e5, p_2)
    gas.settle_transmission(np.array([0.05]))
    for v in (2e-3, 1e-2, -1e-2):
        x = 0.05
        for _ in range(1500):
            gas.advance(np.array([x]), np.array([x + v * 1e-3]), np.zeros(1))
            x += v * 1e-3
        resisted = -40.0 * math.tanh(v / 5e-3)
        assert gas.forces(np.array([x]), np.array([v]))[0] == pytest.approx(resisted, rel=2e-3)
