"""The law of independent edges against the plant: the pushing chamber is steered, the other let off."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from exo_sim.control.metering import chamber_command, edge_command, follow, meter, through_tank
from exo_sim.physics import state
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world

P_S, P_A = 12e5, 101325.0


def plant(p_1, p_2, x, single_acting=False):
    cylinder = paper_cylinder(0.040, 0.016, 0.125, 10e-6, 8e-6, 8e-6, single_acting)
    cylinder["independent"] = 1.0
    gas = Pneumatics(paper_world(P_S), cylinder, dt=2e-5)
    gas.fill(np.array([x]), p_1, p_2)
    return gas


def asked(gas, wanted, rate, v, x):
    c = gas.cylinders[0]
    (p_1, p_2), v_1 = gas.pressures(np.array([x]))[0], c["dead_volume_1"] + c["area_1"] * x
    v_2 = c["dead_volume_2"] + c["area_2"] * (c["stroke"] - x)
    return np.array(meter(c, wanted, rate, v, p_1, 293.15, p_2, 293.15, v_1, v_2, P_S, 293.15, P_A, 293.15, 1.4, 287.05))


@settings(max_examples=60)
@given(
    p_1=st.floats(1.5e5, 11e5), p_2=st.floats(1.1e5, 11e5), x=st.floats(0.02, 0.105), v=st.floats(-0.3, 0.3),
    rate=st.floats(-4e4, 4e4), pushes=st.booleans(),
)  # fmt: skip
def test_the_force_changes_at_the_rate_asked_for(p_1, p_2, x, v, rate, pushes):
    gas = plant(p_1, p_2, x)
    command = asked(gas, 100.0 if pushes else -100.0, rate, v, x)
    assert command[1 if pushes else 0] == -1.0
    before = gas.forces(np.array([x]), np.zeros(1))[0]
    gas.advance(np.array([x]), np.array([x + v * gas.dt]), command)
    made = (gas.forces(np.array([x + v * gas.dt]), np.zeros(1))[0] - before) / gas.dt
    if abs(command[0 if pushes else 1]) < 1.0:
        assert made == pytest.approx(rate, rel=0.05, abs=4e3)


def test_the_idle_chamber_draws_nothing_from_the_supply():
    """A pull let off while the rod goes out: chamber 2 empties, chamber 1 grows and fills from the exhaust."""
    gas = plant(P_A, P_A, 0.03)
    for i in range(200):
        x = 0.03 + 0.2 * i * gas.dt
        gas.advance(np.array([x]), np.array([x + 0.2 * gas.dt]), np.array([-1.0, -1.0]))
    assert gas.integrated[0, state.DRAWN] == 0.0
    assert gas.integrated[0, state.EXHAUSTED] != 0.0
    assert gas.books().mass_residual < 1e-9


def test_gas_squeezed_above_the_supply_goes_back_there():
    command = chamber_command(-1e7, 1.3 * P_S, 293.15, 1e-4, 1e-5, 1e-5, 0.0, 0.0, P_S, 293.15, P_A, 293.15, 1.4, 287.05)
    assert command > 0.0


def test_an_overlap_is_passed_over():
    assert edge_command(0.0, 0.04) == 0.0
    assert edge_command(0.5, 0.04) == pytest.approx(0.52)
    assert edge_command(3.0, 0.04) == 1.0


def test_a_single_acting_cylinder_is_steered_by_chamber_one_whatever_the_sign():
    assert asked(plant(3e5, P_A, 0.05, single_acting=True), -50.0, -1e3, 0.0, 0.05)[1] == -1.0


@settings(max_examples=60)
@given(
    p_1=st.floats(1.5e5, 11e5), p_2=st.floats(1.5e5, 11e5), x=st.floats(0.02, 0.105), v=st.floats(-0.3, 0.3), rate=st.floats(-4e4, 4e4),
)  # fmt: skip
def test_near_a_plan_the_force_changes_at_the_rate_asked_for_and_both_pressures_as_planned(p_1, p_2, x, v, rate):
    gas = plant(p_1, p_2, x)
    c = gas.cylinders[0]
    v_1, v_2 = c["dead_volume_1"] + c["area_1"] * x, c["dead_volume_2"] + c["area_2"] * (c["stroke"] - x)
    planned_2 = 2e5  # chamber 1 as the force then asks
    planned_1 = (rate + planned_2 * c["area_2"]) / c["area_1"]
    given = (p_1, 293.15, p_2, 293.15, v_1, v_2, P_S, 293.15, P_A, 293.15, 0.0, 0.0, 0.0, 1.4, 287.05)
    command = np.array(follow(c, rate, v, p_1, planned_1, p_2, planned_2, *given)[:2])
    before, at = gas.forces(np.array([x]), np.zeros(1))[0], gas.pressures(np.array([x]))[0]
    later = np.array([x + v * gas.dt])
    gas.advance(np.array([x]), later, command)
    if np.abs(command).max() < 1.0:
        assert (gas.forces(later, np.zeros(1))[0] - before) / gas.dt == pytest.approx(rate, rel=0.05, abs=4e3)
        assert (gas.pressures(later)[0] - at) / gas.dt == pytest.approx([planned_1, planned_2], rel=0.1, abs=2e6)


@pytest.mark.parametrize(
    ("wanted", "p", "tank", "comes"),
    [(1e5, 2e5, 3e5, True), (1e5, 2e5, 2.6e5, False), (1e5, 4e5, 3e5, False), (-1e5, 5e5, 3e5, True), (-1e5, 5e5, 3.4e5, False),
     (-1e5, 2e5, 3e5, False)],
)  # fmt: skip
def test_the_tank_comes_first_where_pressures_allow_and_its_own_is_near(wanted, p, tank, comes):
    share, left = through_tank(wanted, p, 293.15, 1e-4, 10e-6, tank, 280.0, 3e5, 1.4, 287.05)
    assert (share > 0.0) == comes
    assert left == (0.0 if comes else wanted)


@pytest.mark.parametrize(("wanted", "p"), [(1e8, 2.8e5), (-1e8, 3.2e5)])
def test_what_the_tank_cannot_give_or_take_is_left_to_the_other_edges(wanted, p):
    share, left = through_tank(wanted, p, 293.15, 1e-4, 10e-6, 3e5, 280.0, 3e5, 1.4, 287.05)
    assert share == 1.0 and 0.0 < left / wanted < 1.0
    assert through_tank(wanted, p, 293.15, 1e-4, 0.0, 3e5, 280.0, 3e5, 1.4, 287.05) == (0.0, wanted)
