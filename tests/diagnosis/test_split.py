"""What is kept for the proof, and what it may say against a name."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.diagnosis.fitted_set import Trial, sizeable
from exo_sim.diagnosis.fitting import Fit
from exo_sim.diagnosis.proof import doubtful
from exo_sim.diagnosis.quantity import Candidate, Quantity
from exo_sim.diagnosis.split import HELD_OUT_SHARE, split


@pytest.mark.parametrize("head", [False, True])
def test_a_lone_recording_is_fit_check_and_proof(head: bool) -> None:
    time = np.linspace(3.0, 13.0, 1001)
    parts = split([("one", time)], head)
    proof, check, fit = parts.held_out("one", time), parts.checking().held_out("one", time), parts.training("one", time)
    assert proof.mean() == pytest.approx(0.5 * HELD_OUT_SHARE, abs=0.002)
    assert check.mean() == pytest.approx(0.5 * HELD_OUT_SHARE, abs=0.002)
    assert (proof | check | fit).all() and not (fit & (proof | check)).any()
    assert (proof & check).sum() <= 1  # the sample between them
    order = np.flatnonzero(proof).mean(), np.flatnonzero(check).mean(), np.flatnonzero(fit).mean()
    assert list(order) == sorted(order, reverse=not head)
    np.testing.assert_array_equal(parts.checking().training("one", time), fit)


@pytest.mark.parametrize(("count", "kept"), [(2, 1), (3, 1), (4, 1), (8, 2)])
def test_of_several_whole_ones_are_kept_and_none_is_a_check(count: int, kept: int) -> None:
    names = [f"r{i}" for i in range(count)]
    parts = split([(name, np.linspace(0.0, 1.0, 50)) for name in names])
    assert list(parts.spans) == names[-kept:] and not parts.check


@pytest.mark.parametrize(
    ("drop", "odds", "doubted"),
    [(0.5, 4.0, False), (0.03, 8.0, True), (-0.6, 24.0, True), (-0.6, 60.0, True), (0.02, 160.0, False), (0.14, 60.0, False)],
)
def test_a_name_stands_where_the_check_or_great_odds_bear_it(drop: float, odds: float, doubted: bool) -> None:
    assert doubtful(drop, odds) is doubted


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

    def number(name: str, prior: tuple[float, float] | None = None) -> Quantity:
        return Quantity("valve_lag", "piston", name, "s", "cylinder", 1e-3, 0.0, 0.1, prior, least=0.0 if prior else 3e-3)

    quantities = tuple(number(name) for name in asked)
    candidate = Candidate("valve_lag", "piston", "+".join(asked), quantities, (tuple(asked.values()),), adds_up=True)
    values = {number("delay", (0.0, 1e-3)): healthy, **dict(zip(quantities, asked.values(), strict=True))}
    trial = Trial((candidate,), Fit(tuple(values), values, np.zeros(4), np.zeros((4, len(values)))))
    assert sizeable(candidate, trial) is large
