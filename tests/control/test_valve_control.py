"""Valve controllers against the plant: the inverse really inverts, and limits hold."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from exo_sim.control.valve_control import force_limits, invert, pi
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world

P_S, P_A = 18.25e5, 101325.0


def plant(p_1, p_2, x):
    gas = Pneumatics(paper_world(P_S), paper_cylinder(0.040, 0.016, 0.125, 10e-6, 8e-6, 8e-6), dt=2e-5)
    gas.fill(np.array([x]), p_1, p_2)
    return gas


@settings(max_examples=60)
@given(
    p_1=st.floats(2e5, 16e5),
    p_2=st.floats(2e5, 16e5),
    x=st.floats(0.02, 0.105),
    v=st.floats(-0.3, 0.3),
    wanted=st.floats(-4e4, 4e4),
)
def test_the_force_changes_at_the_rate_asked_for(p_1, p_2, x, v, wanted):
    """One short step of the real plant under the inverted command gives the wanted dF/dt, wherever the valve can."""
    gas = plant(p_1, p_2, x)
    c, w = gas.cylinders[0], gas.world[0]
    opening = invert(
        wanted, v, p_1, 293.15, p_2, 293.15, c["dead_volume_1"] + c["area_1"] * x,
        c["dead_volume_2"] + c["area_2"] * (c["stroke"] - x), c["area_1"], c["area_2"], c["valve_area"], P_S, 293.15,
        P_A, 293.15, w["k"], w["r"],
    )  # fmt: skip
    before = gas.forces(np.array([x]), np.zeros(1))[0]
    gas.advance(np.array([x]), np.array([x + v * gas.dt]), np.array([opening]))
    rate = (gas.forces(np.array([x + v * gas.dt]), np.zeros(1))[0] - before) / gas.dt
    if abs(opening) < 1.0:
        assert rate == pytest.approx(wanted, abs=0.02 * abs(wanted) + 250.0)
    else:
        assert (rate - wanted) * np.sign(opening) < 250.0 + 0.02 * abs(wanted)


@given(st.floats(-1e4, 1e4), st.floats(-1, 1))
def test_pi_stays_inside_and_does_not_wind_up(error, held):
    command, integral = pi(error, 2000.0, held, 8.0, 40.0, 1e-3)
    assert -1.0 <= command <= 1.0
    if abs(command) == 1.0:
        assert abs(integral) <= max(abs(held), 1.0)
        assert (integral - held) * command <= 0.0
    else:
        assert command == pytest.approx(8.0 * error / 2000.0 + integral)


def test_force_limits_are_full_pressure_against_the_atmosphere():
    gas = plant(P_S, P_A, 0.06)
    c = gas.cylinders[0]
    low, high = force_limits(c["area_1"], c["area_2"], P_S, P_A, P_A)
    assert gas.forces(np.array([0.06]), np.zeros(1))[0] == pytest.approx(high)
    assert plant(P_A, P_S, 0.06).forces(np.array([0.06]), np.zeros(1))[0] == pytest.approx(low)
