"""The books close where what went in is what is there, and say how much is missing where it is not."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.physics import state
from exo_sim.physics.conservation import balance
from exo_sim.physics.pneumatics import paper_world


def changes() -> np.ndarray:
    """Return the change of one cylinder that drew 3 g, let out 1 g, did 100 J of work and took 20 J of heat."""
    change = np.zeros(state.integrated_size(1))
    change[state.DRAWN], change[state.EXHAUSTED] = 3e-3, 1e-3
    change[state.DRAWN_ENTHALPY], change[state.EXHAUSTED_ENTHALPY] = 900.0, 250.0
    change[state.WORK], change[state.HEAT] = 100.0, 20.0
    change[state.MASS_1], change[state.HOSE_MASS_2] = 1.5e-3, 0.5e-3
    change[state.ENERGY_1] = 900.0 - 250.0 - 100.0 + 20.0
    return change


def test_what_went_in_and_out_is_what_is_there() -> None:
    books = balance(paper_world(), 1, changes())
    assert books.mass_residual < 1e-15 and books.energy_residual < 1e-15
    assert (books.drawn, books.work, books.heat) == (pytest.approx([3e-3]), pytest.approx([100.0]), pytest.approx([20.0]))


@pytest.mark.parametrize(
    ("where", "lost", "of_mass", "of_energy"), [(state.MASS_2, 1e-6, 1e-6 / 4e-3, 0.0), (state.ENERGY_2, 2.0, 0.0, 2.0 / 1270.0)]
)
def test_what_is_missing_is_a_share_of_what_passed(where: int, lost: float, of_mass: float, of_energy: float) -> None:
    change = changes()
    change[where] -= lost
    books = balance(paper_world(), 1, change)
    assert books.mass_residual == pytest.approx(of_mass, abs=1e-15) and books.energy_residual == pytest.approx(of_energy, abs=1e-15)


def test_a_shared_tank_is_in_the_books() -> None:
    change, world = changes(), paper_world()
    world["supply_droop"]["volume"] = 1e-3
    shared = state.INTEGRATED
    change[shared + state.SUPPLY_MASS], change[shared + state.SUPPLY_ENERGY] = -3e-3, -900.0
    assert balance(world, 1, change).mass_residual < 1e-15
    change[shared + state.FED] = 1e-3  # fed, and not in the tank
    assert balance(world, 1, change).mass_residual == pytest.approx(1e-3 / 4e-3)


def test_where_nothing_passed_the_residual_is_in_kilograms() -> None:
    change = np.zeros(state.integrated_size(1))
    change[state.MASS_1] = 1e-7
    assert balance(paper_world(), 1, change).mass_residual == 1e-7


def test_what_one_chamber_gives_the_recovery_tank_keeps() -> None:
    change, world = changes(), paper_world()
    world["tank_volume"] = 1e-3
    change[state.MASS_1], change[state.ENERGY_1] = change[state.MASS_1] - 1e-4, change[state.ENERGY_1] - 30.0
    assert balance(world, 1, change).mass_residual == pytest.approx(1e-4 / 4e-3)
    change[state.INTEGRATED + state.TANK_MASS], change[state.INTEGRATED + state.TANK_ENERGY] = 1e-4, 30.0
    books = balance(world, 1, change)
    assert books.mass_residual < 1e-15 and books.energy_residual < 1e-15 and books.recovered == pytest.approx(1e-4)


def test_where_next_to_nothing_passed_the_measure_is_a_millionth_of_what_was_there() -> None:
    """A shut machine whose piston breathes: its work is less than the rounding of the energy inside."""
    start, change = np.zeros(state.integrated_size(1)), np.zeros(state.integrated_size(1))
    start[state.MASS_1], start[state.ENERGY_1] = 1e-4, 25.0
    change[state.WORK] = 1e-18
    books = balance(paper_world(), 1, change, start)
    assert books.energy_residual == pytest.approx(1e-18 / 25e-6) and books.mass_residual == 0.0
    assert balance(paper_world(), 1, changes(), start).energy_residual == balance(paper_world(), 1, changes()).energy_residual
