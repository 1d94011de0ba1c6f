"""A step that its stages do not hold is seen, and taken again until it is held."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from exo_sim.physics import settling, state
from exo_sim.physics.conditions import Chamber
from exo_sim.physics.nodes import change_hose_pressure
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world
from exo_sim.physics.runge_kutta_chebyshev import enough_stages
from exo_sim.physics.state import integrated_size
from exo_sim.physics.step import CLASSIC, chebyshev_step, integrate, moving_numbers
from exo_sim.physics.step_length import step_length
from exo_sim.physics.summed_effects import outward_rate
from exo_sim.physics.terms import OUTWARD_FLOW, Term, within

H = 1e-3


def stiff() -> Pneumatics:
    """Return a cylinder whose first chamber is small, behind a short wide hose."""
    world, cylinder = paper_world(), paper_cylinder(0.025, 0.01, 0.16, 5e-6, 1e-6, 5e-6)
    cylinder["line_restriction"]["area"], cylinder["line_restriction"]["volume"] = 2e-5, 1e-6
    gas = Pneumatics(world, cylinder, dt=H)
    gas.fill(np.array([0.002]), 3e5, 4e5)
    return gas


def after(gas: Pneumatics, stages: int, most: int, pieces: int = 1, steps: int = 1) -> tuple[NDArray[np.float64], int]:
    """Return the integrated state after steps of H seconds, each in equal pieces with so many stages, and how many were tried."""
    size = integrated_size(1)
    y, x0, spool, x, v = gas.vector[:size].copy(), np.array([0.002]), np.array([0.6, -0.6]), np.zeros(1), np.zeros(1)
    tried, faster = 0, 0.0
    for _ in range(steps):
        x1 = x0 + 2e-4
        for i in range(pieces):
            left, h = H * (1.0 - i / pieces), H / pieces
            enough = max(stages, enough_stages(faster * h))
            _, more, too_fast = integrate(
                gas.world[0], gas.cylinders, y, 0.0, x0, x1, left, spool, h, enough, gas._work, x, v, most, False, size
            )
            tried, faster = tried + more, max(faster, too_fast)
    return y, tried


def test_too_few_stages_are_seen_and_the_step_is_taken_again() -> None:
    gas = stiff()
    size = integrated_size(1)
    stocks = slice(0, 8)
    at, speed, opening = np.array([0.002]), np.array([0.2]), np.array([0.6])
    chebyshev_step(gas.world[0], gas.cylinders, gas.vector[:size], 0.0, at, speed, opening, H, 2, gas._work, np.zeros(1), False, size)
    alone = gas._work[3].copy()
    assert not (np.abs(alone - gas.vector[:size]) < gas.vector[:size])[stocks].all(), "two stages alone should not hold this"
    guarded, tried = after(gas, 2, 1000, steps=40)
    assert tried > 40
    fine, _ = after(gas, 4, 10_000, pieces=1000, steps=40)
    enough, _ = after(gas, 20, 1000, steps=40)
    usual = np.abs(enough[stocks] / fine[stocks] - 1.0).max()  # of steps so long, stable throughout
    assert np.abs(guarded[stocks] / fine[stocks] - 1.0).max() < 5.0 * usual < 0.5


def test_enough_stages_are_taken_at_once() -> None:
    gas = stiff()
    at, end, size = np.array([0.002]), np.array([0.0022]), integrated_size(1)
    h, stages = step_length(gas.world[0], gas.cylinders, gas.vector[:size], 0.0, at, end, np.array([0.6, -0.6]), H, 1e-7, 0.0)
    pieces = round(H / h)
    assert after(gas, stages, 10_000, pieces)[1] == pieces


def ringing(length: float, area: float = 6e-6, push: float = 2e3) -> Pneumatics:
    """Return a cylinder with a closed valve in whose hose of 4 mm a wave runs to and fro."""
    world, cylinder = paper_world(), paper_cylinder(0.025, 0.01, 0.16, 5e-6, 1e-4, 1e-4)
    hose = cylinder["line_restriction"]
    hose["area"], hose["length"], hose["volume"] = area, length, 12.6e-6 * length
    gas = Pneumatics(world, cylinder, dt=H)
    gas.fill(np.array([0.05]), 3e5, 4e5)
    change_hose_pressure(gas.cylinders[0], gas.vector, 0, 0, push, 1.4)
    return gas


def rung(gas: Pneumatics, h: float, seconds: float) -> NDArray[np.float64]:
    """Return the integrated state after classic steps of `h`, the piston at rest."""
    y, at, none = gas.vector[: integrated_size(1)].copy(), np.array([0.05]), np.zeros(2)
    for _ in range(round(seconds / h)):
        integrate(
            gas.world[0], gas.cylinders, y, 0.0, at, at.copy(), h, none, h, CLASSIC, gas._work, np.zeros(1), np.zeros(1), 1, False, y.size
        )
    return y


def test_a_classic_step_is_of_fourth_order() -> None:
    gas = ringing(1.0, area=1e-4, push=20.0)  # so little that what holds it back is the wall's linear friction, without kinks
    flows = [state.HOSE_FLOW_1, state.MIDDLE_FLOW_1]
    fine = rung(gas, 3.125e-6, 4e-3)[flows]
    errors = [np.linalg.norm(rung(gas, h, 4e-3)[flows] - fine) for h in (1e-4, 5e-5, 2.5e-5)]
    assert np.linalg.norm(fine) > 1e-8
    orders = np.log2([errors[0] / errors[1], errors[1] / errors[2]])
    assert (np.abs(orders - 4.0) < 0.4).all()


def test_a_wave_is_followed_in_classic_steps_that_turn_it_by_a_radian_and_a_half() -> None:
    gas = ringing(0.8)
    at, contents = np.array([0.05]), [state.MASS_1, state.HOSE_MASS_1, state.MIDDLE_MASS_1]
    y = gas.vector[: integrated_size(1)]
    h, stages = step_length(gas.world[0], gas.cylinders, y, 0.0, at, at, np.zeros(2), 0.012, 1e-7, 0.0)
    assert stages == CLASSIC and 1.4 < h * 4.0 * 343.0 / 0.8 < 1.65  # sound in a room, over 0.8 m
    coarse, fine = rung(gas, h, 0.012), rung(gas, h / 32.0, 0.012)
    flows = [state.HOSE_FLOW_1, state.MIDDLE_FLOW_1]
    assert np.abs(coarse[flows] - fine[flows]).max() < 0.1 * np.abs(fine[flows]).max()
    assert coarse[contents].sum() == pytest.approx(fine[contents].sum(), rel=1e-13)


def test_a_classic_step_that_is_not_stable_is_halved() -> None:
    gas = ringing(0.6)
    gas.cylinders["wall_heat_transfer"]["conductance"] = 40.0
    at, none = np.array([0.05]), np.zeros(2)
    y = gas.vector[: integrated_size(1)].copy()
    y[state.ENERGY_1] *= 1.1
    _, tried, _ = integrate(
        gas.world[0], gas.cylinders, y, 0.0, at, at.copy(), 0.02, none, 0.02, CLASSIC, gas._work, np.zeros(1), np.zeros(1), 1000, False,
        y.size,
    )
    assert tried > 2 and np.isfinite(y).all() and (y[:8] > 0.0).all()


def test_what_cannot_be_held_ends_with_the_last_state_that_was() -> None:
    gas = stiff()
    gas.cylinders["wall_heat_transfer"]["conductance"] = 1e3
    y, tried = after(gas, 2, 2)
    assert tried == 3 and np.isfinite(y).all() and (y[:8] > 0.0).all()


class Leak(NamedTuple):
    area: float


class Wall(NamedTuple):
    conductance: float


@within
def _blow_off(p, here, there, world):
    return p.area * max(here.p - 5e5, 0.0)


@within
def _radiation(p, here, world):
    return p.conductance * 1e-7 * (here.wall**4 - here.t**4)


@pytest.mark.parametrize("pressure", [4.95e5, 5e5, 6e5])
def test_a_flow_that_declares_no_bound_is_bounded_by_its_slope(pressure: float) -> None:
    """An isothermal volume behind w = a (p - p_0) settles at a R T / V; a bound for warm gas, adiabatic, is above.

    A little below the pressure at which it opens the bound already sees what a step may lead to.
    """
    world = paper_world()[0]
    here = Chamber(1, pressure, 293.15, 1e-5, 293.15, 8e-4, 0.05, 0.0, 0.05, 0.0, 8e-4, 0.1)

    estimated = settling.by_outward_flow(_blow_off)(Leak(1e-8), here, here, 1e-3, world)
    steepest = 1e-8 * 287.05 * 293.15 / 1e-5
    assert 0.9 * steepest <= estimated <= 2.5 * steepest


def test_heat_that_declares_no_bound_is_bounded_by_its_slope() -> None:
    world = paper_world()[0]
    here = Chamber(1, 3e5, 350.0, 1e-6, 293.15, 8e-4, 0.05, 0.0, 0.05, 0.0, 8e-4, 0.1)

    estimated = settling.by_heat_flow(_radiation)(Wall(1.0), here, world)
    slope = 4e-7 * 350.0**3 * 0.4 * 350.0 / (3e5 * 1e-6)
    assert slope <= estimated <= 1.5 * slope


def test_a_declared_bound_is_used_and_an_undeclared_one_estimated() -> None:
    made = Term("made up", of_gas=True)
    functions: dict[str, tuple[Any, Any]] = {**OUTWARD_FLOW._functions}
    leak, flow = functions["external_leakage"]
    made.of(leak)(flow.py_func)
    cylinder, world = paper_cylinder(0.032, 0.012, 0.1, 5e-6), paper_world()[0]
    cylinder["external_leakage"]["laminar_1"] = 1e-15
    here = Chamber(1, 6e5, 293.15, 1e-5, 293.15, 8e-4, 0.05, 0.0, 0.05, 0.0, 8e-4, 0.1)
    declared = outward_rate(cylinder[0], here, here, 1e-3, world)
    estimated = made.fastest("cylinder", settling.by_outward_flow)(cylinder[0], here, here, 1e-3, world)
    assert estimated == pytest.approx(declared, rel=0.03)


@pytest.mark.parametrize(
    ("area", "length", "capacity", "moving"),
    [(0.0, 0.0, 0.0, 4), (4e-6, 0.0, 0.0, 8), (4e-6, 1.0, 0.0, 18), (0.0, 0.0, 5.0, 18)],
)
def test_only_what_moves_is_followed_where_nobody_reads_the_books(area: float, length: float, capacity: float, moving: int) -> None:
    gas = stiff()
    hose, wall = gas.cylinders["line_restriction"], gas.cylinders["moving_wall_temperature"]
    hose["area"], hose["volume"], hose["length"], wall["heat_capacity"] = area, 5e-6, length, capacity
    assert moving_numbers(gas.world[0], gas.cylinders, gas.vector[: integrated_size(1)]) == moving
    gas.world["exhaust_back_pressure"]["area"] = 1e-5
    assert moving_numbers(gas.world[0], gas.cylinders, gas.vector[: integrated_size(1)]) == integrated_size(1)
