"""What several parameters have in common stands where the priors want it, and nothing that shows changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from exo_sim.diagnosis.estimation.common_part import with_common_parts_split
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.estimation.prior_terms import prior_terms
from exo_sim.physics.effects.valve_edges import EDGES

WIDTH = FreeParameter("valve_deadband", "piston", "width", "1", Target.CYLINDER, 0.01, 0.0, 0.9)
LAPS = tuple(
    FreeParameter("valve_edges", "piston", f"overlap_{edge}", "1", Target.CYLINDER, 0.01, -0.5, 0.9, (0.0, 0.01)) for edge in EDGES
)


def fitted(width: FreeParameter, values: tuple[float, ...], laps: tuple[FreeParameter, ...] = LAPS) -> Fit:
    parameters = (width, *laps)
    at = dict(zip(parameters, values, strict=True))
    rows, jacobian = prior_terms(parameters, at)
    return Fit(parameters, at, np.ones(9), np.ones((9, len(parameters))), float(rows @ rows), jacobian)


def test_equal_overlaps_are_the_dead_band() -> None:
    before = fitted(WIDTH, (0.042, -0.011, -0.013, -0.016, -0.016))
    after = with_common_parts_split(before)
    assert after.values[WIDTH] == pytest.approx(0.028)
    assert sum(after.values[q] for q in LAPS) == pytest.approx(0.0, abs=1e-12)
    for lap in LAPS:
        assert after.values[WIDTH] + after.values[lap] == pytest.approx(before.values[WIDTH] + before.values[lap])
    assert after.penalty < before.penalty and after.sse == before.sse


def test_a_known_width_gives_as_much_as_its_prior_bears() -> None:
    known = replace(WIDTH, prior=(0.04, 0.005))
    after = with_common_parts_split(fitted(known, (0.04, 0.01, 0.01, 0.01, 0.01)))
    for step in (-1e-3, 1e-3):
        moved = {q: value + (step if q == known else -step) for q, value in after.values.items()}
        rows, _ = prior_terms(after.parameters, moved)
        assert float(rows @ rows) > after.penalty


def test_no_bound_is_passed() -> None:
    after = with_common_parts_split(fitted(WIDTH, (0.002, -0.01, -0.01, -0.01, -0.01)))
    assert after.values[WIDTH] == 0.0 and after.values[LAPS[0]] == pytest.approx(-0.008)


def test_without_all_of_them_nothing_changes() -> None:
    some = fitted(WIDTH, (0.04, -0.01, -0.01), LAPS[:2])
    assert with_common_parts_split(some) is some
