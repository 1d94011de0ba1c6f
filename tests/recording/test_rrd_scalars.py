"""Arrays handed to rerun are those that it would make itself."""

from __future__ import annotations

import numpy as np
import rerun as rr

from exo_sim.recording import rrd_scalars


def test_column_is_what_rerun_makes_of_the_values() -> None:
    values = np.array([[0.5, np.nan, -2.0], [1.0, 2.0, 3.0]]).T  # columns that are not in one piece
    for one in values.T:
        (mine,), (theirs,) = rrd_scalars.column(one), rr.Scalars.columns(scalars=one)
        assert mine.component_descriptor() == theirs.component_descriptor()
        assert mine.as_arrow_array().type == theirs.as_arrow_array().type
        np.testing.assert_array_equal(mine.as_arrow_array().flatten().to_numpy(), one)
        np.testing.assert_array_equal(mine.as_arrow_array().offsets.to_numpy(), np.arange(len(one) + 1))


def test_looks_are_what_rerun_makes_of_tuples_and_lists() -> None:
    mine = rr.SeriesLines(colors=rrd_scalars.colour((90, 170, 255)), widths=rrd_scalars.width(1.5))
    theirs = rr.SeriesLines(colors=[(90, 170, 255, 255)], widths=[1.5])
    assert mine.colors == theirs.colors
    assert mine.widths == theirs.widths
    see_through = rr.SeriesLines(colors=rrd_scalars.colour((1, 2, 3, 4)))
    assert see_through.colors == rr.SeriesLines(colors=[(1, 2, 3, 4)]).colors
