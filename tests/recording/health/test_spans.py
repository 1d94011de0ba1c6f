"""Runs of rows, and how a finding says where they are."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.recording.data_quality_finding import MOST_SPANS
from exo_sim.recording.health.spans import listed, runs, where

TIME = np.arange(1000.0) * 0.01


@pytest.mark.parametrize(("mask", "spans"), [("0110", [[1, 3]]), ("1001", [[0, 1], [3, 4]]), ("000", []), ("11", [[0, 2]])])
def test_runs_are_half_open(mask: str, spans: list[list[int]]) -> None:
    assert runs(np.array([each == "1" for each in mask])).tolist() == spans


def test_rows_are_counted_from_one_and_times_are_of_the_first_and_last_sample() -> None:
    one, two = runs(TIME == 0.05), runs((TIME > 0.095) & (TIME < 0.195) | (TIME == 5.0))
    assert where(one, TIME) == "in row 6 (0.05 s)"
    assert where(two, TIME) == "in 2 spans, first rows 11-20 (0.1-0.19 s)"
    assert listed(two, TIME) == (((10, 20), (500, 501)), ((0.1, pytest.approx(0.19)), (5.0, 5.0)))


def test_no_more_than_so_many_are_listed() -> None:
    assert len(listed(runs(np.arange(1000) % 2 == 0), TIME)[0]) == MOST_SPANS
