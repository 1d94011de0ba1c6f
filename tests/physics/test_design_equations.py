"""The paper's steady relations: the examples in their docstrings, and what follows from conservation."""

from __future__ import annotations

import doctest

import pytest

from exo_sim.physics import design_equations, nozzle


def test_the_examples_of_the_docstrings_hold() -> None:
    tried = doctest.testmod(design_equations)
    assert tried.attempted > 10 and tried.failed == 0


def test_the_throat_passes_what_it_was_sized_for() -> None:
    area = design_equations.throat_area(0.0187, 1.8e6, 293.15)
    assert nozzle.mass_flow(area, 1.8e6, 293.15, 1e5, 1.4, 287.05) == pytest.approx(0.0187, rel=1e-12)


def test_free_air_and_mass_flow_are_the_same_gas() -> None:
    flow = 8e-4
    by_mass = design_equations.mass_flow(flow, 1.8e6, 293.15)
    assert by_mass == pytest.approx(design_equations.mass_flow(design_equations.free_air(flow, 1.8e6), 101325.0, 293.15))


def test_a_stroke_does_no_more_work_than_its_gas_could() -> None:
    power = design_equations.rod_power(7e5, 101325.0, 8e-4, 7e-4, 101325.0, 0.5)
    flow = design_equations.mass_flow(design_equations.supply_flow(power, 7e5, 7e5, 101325.0, 8e-4, 7e-4, 101325.0), 7e5, 293.15)
    assert 0.0 < power < design_equations.available_power(flow, 7e5, 293.15)
