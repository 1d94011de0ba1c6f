"""What an effect is worth in held-out time: in how many blocks it gains counts, not how much the loudest of them does."""

from __future__ import annotations

import math

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.selection.held_out_gain import gain_in_errors

ROWS = waves.Waves()
NOISE = np.random.default_rng(3).standard_normal(ROWS.size)


def test_what_gains_in_every_block_gains_surely_and_the_other_way_round() -> None:
    worse = NOISE + 3.0 * waves.SHAPES["slow"]
    gain = gain_in_errors(ROWS, worse, NOISE)
    assert gain > 4.0 and gain_in_errors(ROWS, NOISE, worse) == pytest.approx(-gain)


@pytest.mark.parametrize("size", [10.0, 1e3, 1e6])
def test_what_gains_in_one_block_does_not_however_much(size: float) -> None:
    burst = np.where(ROWS.blocks == 4, size, 0.0)
    assert 0.0 < gain_in_errors(ROWS, NOISE + burst, NOISE) < 1.5


def test_a_block_that_something_else_makes_loud_does_not_hide_the_others() -> None:
    loud = np.where(ROWS.blocks == 4, 300.0 * waves.SHAPES["quick"], 0.0)
    assert gain_in_errors(ROWS, NOISE + loud + 3.0 * waves.SHAPES["slow"], NOISE + loud) > 3.0


def test_nothing_gains_nothing_and_one_block_says_nothing() -> None:
    assert gain_in_errors(ROWS, NOISE, NOISE) == 0.0
    one = waves.Waves()
    one.blocks = np.zeros_like(one.blocks)
    assert gain_in_errors(one, 9.0 * NOISE, NOISE) == -math.inf
    assert gain_in_errors(ROWS, np.full(ROWS.size, math.nan), NOISE) == -math.inf
