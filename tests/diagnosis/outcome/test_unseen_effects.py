"""What a recording would not have shown at the size that is often met."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.outcome.unseen_effects import unseen_effects

LEAK = FreeParameter("piston_leakage", "piston", "area", "m^2", Target.CYLINDER, 1e-8, 0.0, 1e-6)
ROWS = np.sin(np.arange(400.0))


def asked(kind: Kind = Kind.MISSING_PHYSICS) -> Candidate:
    return Candidate("piston_leakage", "piston", "area", (LEAK,), ((3e-9,),), kind=kind)


def result(by_leak: float) -> Any:
    """Return a subsystem of 400 independent rows that a leak of 1 m^2 changes by so much, and no number is fitted to."""
    noise = np.random.default_rng(3).normal(0.0, 1.0, ROWS.size)
    model = SimpleNamespace(
        blocks=(slice(0, ROWS.size),),
        residual_of=lambda plant: noise + by_leak * ROWS * plant.get(LEAK, 0.0),
        apply=lambda values, fixed: values,
    )
    final = SimpleNamespace(fit=SimpleNamespace(values={}), fixed=())
    return SimpleNamespace(model=model, final=final, fits=SimpleNamespace(standard_errors=lambda one: {}), plant_of=lambda one: {})


@pytest.mark.parametrize(("change", "unseen"), [(1.0, ()), (0.05, ("piston_leakage",))])
def test_an_effect_is_unseen_where_it_changes_predictions_by_little(change: float, unseen: tuple[str, ...]) -> None:
    """400 rows that are changed by one standard deviation times a sine give odds of 10^43, by a twentieth of that 10^0.1."""
    assert unseen_effects(result(change / 3e-9), (asked(),)) == unseen


def test_laws_and_sensors_are_not_asked() -> None:
    assert unseen_effects(result(0.0), (asked(Kind.SENSOR), replace(asked(), is_law=True))) == ()
