"""A fitted set of candidates: prerequisites, and what exceeds a healthy machine."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.selection.fitted_model import FittedModel, as_in_a_healthy_machine, exceeds_healthy_limit, is_at_bound, remains


@pytest.mark.parametrize(
    ("asked", "healthy", "large"),
    [
        ({"time_constant": 0.002, "delay": 0.0}, 0.0, False),
        ({"time_constant": 0.002, "delay": 0.002}, 0.0, True),
        ({"time_constant": 0.002}, 0.002, True),
        ({"time_constant": 0.002, "delay": 0.0}, 0.002, False),  # the fitted delay stands in the healthy one's place
    ],
)
def test_parts_of_one_thing_are_held_against_the_limit_together(asked: dict[str, float], healthy: float, large: bool) -> None:
    """A valve that is late by 3 ms is healthy, however that is shared between waiting and following."""

    def number(name: str, prior: tuple[float, float] | None = None) -> FreeParameter:
        return FreeParameter("valve_lag", "piston", name, "s", Target.CYLINDER, 1e-3, 0.0, 0.1, prior, healthy_limit=0.0 if prior else 3e-3)

    parameters = tuple(number(name) for name in asked)
    candidate = Candidate("valve_lag", "piston", "+".join(asked), parameters, (tuple(asked.values()),), additive=True)
    values = {number("delay", (0.0, 1e-3)): healthy, **dict(zip(parameters, asked.values(), strict=True))}
    model = FittedModel((candidate,), Fit(tuple(values), values, np.zeros(4), np.zeros((4, len(values)))))
    assert exceeds_healthy_limit(candidate, model) is large


@pytest.mark.parametrize(
    ("lag", "delay", "additive", "there"),
    [(0.0024, 0.003, True, True), (0.0024, 0.003, False, False), (0.001, 0.0015, True, False), (0.0, 0.003, True, False)],
)
def test_left_out_an_effect_is_still_there_where_healthy_parts_of_it_make_up_more_than_a_healthy_machine_has(
    lag: float, delay: float, additive: bool, there: bool
) -> None:
    values = {
        FreeParameter("valve_lag", "piston", name, "s", Target.CYLINDER, 1e-3, 0.0, 3e-3, (0.0, 1e-3)): value
        for name, value in (("time_constant", lag), ("delay", delay))
    }
    asked = FreeParameter("valve_lag", "piston", "delay", "s", Target.CYLINDER, 1e-3, 0.0, 0.1, healthy_limit=3e-3)
    candidate = Candidate("valve_lag", "piston", "delay", (asked,), ((5e-3,),), additive=additive)
    without = FittedModel((), Fit(tuple(values), values, np.zeros(4), np.zeros((4, 2))))
    assert remains(candidate, without) is there
    if there:
        assert sum(as_in_a_healthy_machine(candidate, without).values()) == pytest.approx(3e-3)
    with_it = FittedModel((candidate,), Fit((asked,), {asked: 0.006}, np.zeros(4), np.zeros((4, 1))))
    assert not remains(candidate, with_it)


def test_how_a_law_goes_on_is_no_part_of_its_size() -> None:
    """A valve that is late by 2 ms is healthy, however much more slowly it closes than it opens."""
    late = FreeParameter("valve_lag", "piston", "time_constant", "s", Target.CYLINDER, 1e-3, 0.0, 0.5, healthy_limit=3e-3)
    closing = FreeParameter("valve_lag", "piston", "closing_excess", "1", Target.CYLINDER, 0.5, -0.9, 9.0)
    candidate = Candidate("valve_lag", "piston", "time_constant+closing_excess", (late, closing), ((5e-3, 0.6),), additive=True)
    for size, large in ((0.002, False), (0.004, True)):
        values = {late: size, closing: 0.8}
        model = FittedModel((candidate,), Fit((late, closing), values, np.zeros(4), np.zeros((4, 2))))
        assert exceeds_healthy_limit(candidate, model) is large


@pytest.mark.parametrize(("error", "surely"), [(0.0002, True), (0.00064, False)])
def test_a_number_surely_exceeds_the_limit_where_the_odds_of_it_do(error: float, surely: bool) -> None:
    """0.0039 against 0.0025: with an error of 0.00064 the likelihood ratio is 10, of 0.0002 it is 10^10; 100 is asked."""
    width = FreeParameter("valve_hysteresis", "piston", "width", "1", Target.CYLINDER, 1e-3, 0.0, 0.9, healthy_limit=0.0025)
    candidate = Candidate("valve_hysteresis", "piston", "width", (width,), ((0.01,),))
    model = FittedModel((candidate,), Fit((width,), {width: 0.0039}, np.zeros(4), np.zeros((4, 1))))
    assert exceeds_healthy_limit(candidate, model)
    assert exceeds_healthy_limit(candidate, model, {width: error}) is surely


@pytest.mark.parametrize(
    ("area", "volume", "ends"),
    [
        (1e-6, 5e-6, False),
        (2e-6, 5e-6, False),  # too wide to throttle, and five times the dead volume: it is there by the gas that it holds
        (2e-6, 0.2e-6, True),  # ... and as much as a dead volume may be off: nothing was found
        (1e-8, 5e-6, True),  # closed
        (1e-6, 1e-7, False),  # its volume is no number that it needs
    ],
)
def test_a_hose_too_wide_to_throttle_is_found_by_the_gas_that_it_holds(area: float, volume: float, ends: bool) -> None:
    parameters = (
        FreeParameter("line_restriction", "piston", "area", "m^2", Target.CYLINDER, 1e-6, 1e-8, 2e-6, logarithmic=True),
        FreeParameter(
            "line_restriction", "piston", "volume", "m^3", Target.CYLINDER, 1e-6, 1e-7, 1e-3, logarithmic=True,
            displaces=((("dead_volume", "piston", "dead_volume_1"), 1e6),),
        ),
    )  # fmt: skip
    candidate = Candidate("line_restriction", "piston", "area+volume", parameters, ((area, volume),))
    model = FittedModel.at(dict(zip(parameters, (area, volume), strict=True)), (candidate,))
    assert is_at_bound(candidate, model) is ends
