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


AREA = FreeParameter("flow_capacity", "piston", "valve_area", "1", Target.FACTOR, 0.1, 0.05, 10.0, (1.0, 0.1), neutral=1.0)
SIZES = tuple(
    FreeParameter("valve_edges", "piston", f"excess_{edge}", "1", Target.CYLINDER, 0.05, -0.95, 4.0, (0.0, 0.05), healthy_limit=0.15)
    for edge in EDGES
)


def areas(values: dict[FreeParameter, float]) -> list[float]:
    return [values[AREA] * (1.0 + value) for q, value in values.items() if q is not AREA]


def edges_of(factor: float, excess: tuple[float, ...], sizes: tuple[FreeParameter, ...] = SIZES) -> Fit:
    parameters = (AREA, *sizes)
    at = dict(zip(parameters, (factor, *excess), strict=True))
    rows, jacobian = prior_terms(parameters, at)
    shown = np.array([[1.0 + e for e in excess], *np.diag([factor] * len(excess))]).T * [q.slope(at[q]) for q in parameters]
    return Fit(parameters, at, np.array(areas(at)) - 1.0, shown, float(rows @ rows), jacobian)


@pytest.mark.parametrize(
    ("factor", "excess", "expected"),
    [
        (0.86, (0.16, -0.14, 0.17, -0.15), (0.0, -0.26, 0.0, -0.27)),  # small exhaust edges, not a small valve with large supply edges
        (0.95, (-0.15, -0.16, -0.15, -0.15), (0.0, -0.01, 0.0, 0.0)),  # a small valve with edges that are alike
        (1.05, (-0.01, 0.3, 0.01, 0.0), (0.0, 0.31, 0.02, 0.01)),
    ],
)
def test_as_few_edges_as_can_be_are_of_another_size(factor: float, excess: tuple[float, ...], expected: tuple[float, ...]) -> None:
    before = edges_of(factor, excess)
    after = with_common_parts_split(before)
    assert [after.values[q] for q in SIZES] == pytest.approx(expected, abs=0.015)
    assert areas(after.values) == pytest.approx(areas(before.values)) and after.sse == before.sse
    assert after.jacobian == pytest.approx(edges_of(*(after.values[AREA], tuple(after.values[q] for q in SIZES))).jacobian)


def test_edges_within_what_healthy_valves_have_stay_where_their_fit_left_them() -> None:
    healthy = tuple(replace(q, healthy_limit=0.0) for q in SIZES)
    before = edges_of(0.9, (0.1, -0.1, 0.1, -0.1), healthy)
    assert with_common_parts_split(before) is before
    alone = edges_of(0.9, (0.1,), SIZES[:1])
    assert with_common_parts_split(alone) is alone
