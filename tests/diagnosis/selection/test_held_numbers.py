"""Bounds of numbers that a fit moved too far: data sheets, and of parts of a quantity what is healthy of them together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis.waves import parameter

from exo_sim.diagnosis.selection.held_numbers import is_at_end, ways_to_hold
from exo_sim.diagnosis.selection.quantity_parts import quantity_of

VOLUME = parameter("dead_volume", "slow", prior=(1.0, 0.15))
WAITS, FOLLOWS = (replace(parameter("valve_lag", name, prior=(0.0, 2.0)), low=0.0, high=3.0) for name in ("slow", "quick"))
LIMITS = {quantity_of(WAITS): 3.0}


def test_a_number_is_held_within_two_standard_deviations() -> None:
    (way,) = ways_to_hold((VOLUME,), {VOLUME: 2.0}, np.eye(1), LIMITS)
    held = way.bounded[VOLUME]
    assert (held.low, held.high) == (pytest.approx(0.7), pytest.approx(1.3))
    assert way.is_at_end([held], {held: 1.3}) and not way.is_at_end([held], {held: 1.2})
    assert is_at_end(held, 1.3) and not is_at_end(replace(held, prior=None), 1.3)


def test_parts_are_shared_out_as_the_fit_would_and_so_that_each_has_the_most() -> None:
    """Of parts that only together are known, what is too much is taken from the one that the fit knows least."""
    values, known = {WAITS: 0.3, FOLLOWS: 2.9}, np.diag([0.01, 1.0])
    most = [[way.bounded[q].high for q in (WAITS, FOLLOWS)] for way in ways_to_hold((WAITS, FOLLOWS), values, known, LIMITS)]
    nearest, waiting, following = most
    assert nearest == [pytest.approx(0.298, abs=1e-3), pytest.approx(2.702, abs=1e-3)]
    assert waiting == [pytest.approx(2.85), pytest.approx(0.15)] and following == [pytest.approx(0.15), pytest.approx(2.85)]
    sure = replace(FOLLOWS, prior=(0.0, 1.0))
    narrow, *_ = ways_to_hold((WAITS, sure), {WAITS: 0.3, sure: 2.9}, known, LIMITS)
    assert max(q.high for q in narrow.bounded.values()) == pytest.approx(2.0)


def test_parts_are_at_their_end_where_together_they_are_all_that_is_healthy() -> None:
    way = ways_to_hold((WAITS, FOLLOWS), {WAITS: 0.3, FOLLOWS: 2.9}, np.eye(2), LIMITS)[1]
    waits, follows = way.bounded[WAITS], way.bounded[FOLLOWS]
    assert way.is_at_end((waits, follows), {waits: 2.85, follows: 0.15})
    assert not way.is_at_end((waits, follows), {waits: 1.0, follows: 0.15})


def test_each_place_is_held_against_what_is_healthy_there() -> None:
    """Two valves that are late by 2.5 each are both healthy."""
    every = [replace(q, where=where) for where in ("hip", "knee") for q in (WAITS, FOLLOWS)]
    values = dict(zip(every, (2.0, 0.5, 2.0, 0.5), strict=True))
    (way,) = ways_to_hold(every, values, np.eye(4), {quantity_of(q): 3.0 for q in every})
    assert {q.high for q in way.bounded.values()} == {3.0} and way.limits == {}
