"""What the pages of a sizing share."""

import pytest

from exo_sim.report.sizing_frame import ROWS, ranges, spread


@pytest.mark.parametrize("chosen", [0, 7, 41, 499])
def test_a_long_front_is_thinned_evenly_with_the_chosen_in_it(chosen):
    shown = spread(500, chosen)
    assert len(shown) in (ROWS - 1, ROWS) and chosen in shown and shown[0] == 0 and shown[-1] == 499
    assert shown == sorted(set(shown)) and max(b - a for a, b in zip(shown, shown[1:])) <= 14


def test_a_short_front_is_shown_whole():
    assert spread(ROWS, 3) == list(range(ROWS))


def test_numbers_as_ranges():
    assert ranges([4, 1, 2, 3, 9, 12, 11]) == "1-4, 9, 11-12"
    assert ranges([]) == ""
