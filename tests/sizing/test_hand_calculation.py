"""The paper's sizing example, and what each of its corrections changes."""

from __future__ import annotations

import pytest

from exo_sim.sizing.hand_calculation import papers_example

FOUND = {step.what: step for step in papers_example()}


def value(beginning: str) -> float:
    (step,) = (step for what, step in FOUND.items() if what.startswith(beginning))
    return step.value


def test_one_horsepower_by_hand() -> None:
    """6600 in lbf/s against 125 psi net, from 250 psi: 52.8 in^3/s."""
    assert value("supply flow, half of the gauge") == pytest.approx(6600.0 / 125.0, rel=1e-3)


def test_half_of_the_absolute_pressure_leaves_less_to_work_with() -> None:
    net = 0.5 * (250.0 + 14.6959)
    assert value("with half of the absolute") == pytest.approx(6600.0 / net, rel=1e-3)


def test_what_the_paper_leaves_out_asks_for_more_or_other_gas() -> None:
    printed = value("supply flow, half of the gauge")
    assert value("with a rod of a quarter") != pytest.approx(printed, rel=0.01)
    assert value("with 10 % of the supply lost") > printed


def test_the_same_gas_in_other_units() -> None:
    """52.8 in^3/s at 264.7 psi are 18.01 times as much at one atmosphere, and 1.204 g/L at 20 C."""
    litres = 52.8 * 0.0254**3 * 1e3 * 264.6959 / 14.6959
    assert value("the same flow as free air") == pytest.approx(litres, rel=1e-3)
    assert value("as mass") == pytest.approx(litres * 1.2041, rel=2e-3)


def test_no_machine_gives_more_work_than_there_is() -> None:
    assert 0.0 < value("share of the work") < 100.0
