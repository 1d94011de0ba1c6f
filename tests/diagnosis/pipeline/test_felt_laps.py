"""Where a valve's edges open is free where it explains the gas, and only there."""

from __future__ import annotations

import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.pipeline.felt_laps import with_felt_laps

LAP = FreeParameter("valve_edges", "piston", "overlap_supply_1", "1", Target.SENSOR, 1.0, -50.0, 50.0, (0.0, 20.0))
SIZE = FreeParameter("valve_edges", "piston", "excess_supply_1", "1", Target.SENSOR, 1.0, -50.0, 50.0, (0.0, 20.0))
SAID = FreeParameter("valve_edges", "piston", "overlap_supply_1", "1", Target.SENSOR, 1.0, -50.0, 50.0, (3.0, 20.0))
SHAPES = {"overlap_supply_1": waves.SHAPES["slow"], "excess_supply_1": waves.SHAPES["level"], "quick": waves.SHAPES["quick"]}


def gas(bound: float, **sizes: float) -> waves.Waves:
    return waves.Waves(bound, SHAPES, **sizes)


@pytest.mark.parametrize(
    ("bound", "lap", "other", "felt"),
    [(5.0, 0.0, 0.0, True), (1.5, 20.0, 0.0, True), (1.5, 40.0, 8.0, True), (1.5, 0.5, 30.0, False), (50.0, 0.5, 30.0, True)],
    ids=["healthy", "explains all", "explains most", "beside another error", "within what healthy machines leave"],
)
def test_it_is_free_where_it_explains_the_gas(bound: float, lap: float, other: float, felt: bool) -> None:
    model = gas(bound, overlap_supply_1=lap, quick=other)
    assert with_felt_laps(model, (SIZE, LAP)) == ((SIZE, LAP) if felt else (SIZE,))


def test_what_the_owner_says_stays_and_nothing_is_asked_without_time() -> None:
    model = gas(0.1, quick=30.0)
    assert with_felt_laps(model, (SIZE, SAID)) == (SIZE, SAID)
    assert with_felt_laps(model, (SIZE, LAP), is_spent=lambda: True) == (SIZE,)
