"""Numbers of two pieces are those of the whole."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.simulation.running_statistics import Change, Least, Mean, Peak, Rms, joined, values

WHOLE = np.random.default_rng(4).standard_normal(50)


@pytest.mark.parametrize("at", [1, 20, 49])
@pytest.mark.parametrize(
    ("kind", "number"), [(Mean, np.mean(WHOLE)), (Rms, np.sqrt(np.mean(WHOLE**2))), (Peak, WHOLE.max()), (Least, WHOLE.min())]
)
def test_two_pieces_make_the_number_of_all_rows(kind: type[Mean], number: float, at: int) -> None:
    assert kind.of(WHOLE[:at]).joined(kind.of(WHOLE[at:])).value() == pytest.approx(number, rel=1e-12)


def test_a_change_counts_cycles_of_both_pieces() -> None:
    assert Change(1.0, 3.0, 2.0).joined(Change(3.0, 8.0, 1.5)).value() == 2.0


def test_nested_numbers_are_joined_in_their_places_and_the_later_stands_where_there_is_none() -> None:
    first = {"legs": [{"gas": Mean(2.0, 1)}, {"gas": Mean(4.0, 1)}], "unit": "g"}
    later = {"legs": [{"gas": Mean(6.0, 1)}, {"gas": Mean(0.0, 1)}], "unit": "kg"}
    assert values(joined(first, later)) == {"legs": [{"gas": 4.0}, {"gas": 2.0}], "unit": "kg"}
