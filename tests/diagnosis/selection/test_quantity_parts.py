"""Parts of one quantity: which they are, how much together, and how much is healthy."""

from __future__ import annotations

from dataclasses import replace

import pytest
from diagnosis.waves import candidate, parameter

from exo_sim.diagnosis.selection.quantity_parts import healthy_limits, parts_of, quantity_of, together, weights_of

DELAY, SLOW = parameter("valve_lag", "slow"), parameter("valve_lag", "quick")


def test_numbers_of_another_place_or_unit_are_no_part_of_it() -> None:
    elsewhere, shape = replace(SLOW, where="other"), replace(SLOW, parameter="closing_excess", unit="s")
    again = replace(DELAY, prior=(0.0, 1.0))
    assert parts_of(quantity_of(DELAY), (DELAY, SLOW, elsewhere, shape, again)) == (again, SLOW)


def test_parts_add_up_away_from_neutral_either_way() -> None:
    values = {DELAY: -0.5, SLOW: 2.0}
    assert together((DELAY, SLOW), values) == pytest.approx(2.5)
    assert weights_of((DELAY, SLOW), values) == {DELAY: -1.0, SLOW: 1.0}


def test_a_candidate_without_parameters_says_nothing_of_what_is_healthy() -> None:
    parts = tuple(replace(q, healthy_limit=limit) for q, limit in ((DELAY, 3.0), (SLOW, 0.0)))
    whole = replace(candidate("valve_lag", "slow", "quick"), parameters=parts, additive=True)
    bare = replace(whole, form="", parameters=())
    assert healthy_limits((whole, bare, candidate("base", "slow"))) == {quantity_of(DELAY): 3.0}
