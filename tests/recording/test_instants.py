from __future__ import annotations

import pytest

from exo_sim.recording.instants import instant


@pytest.mark.parametrize(
    ("at", "first", "last", "words"),
    [
        (0.2, 0.0, 6.0, "0.2"), (1.234567, 0.0, 6.0, "1.23457"), (1.7e9 + 0.2, 1.7e9, 1.7e9 + 6.0, "1700000000.2"),
        (1234.567, 1230.0, 1240.0, "1234.567"), (-3.0, -3.0, 3.0, "-3"), (5.0, 5.0, 5.0, "5"), (0.0, 0.0, 0.0, "0"),
    ],
)  # fmt: skip
def test_rows_are_told_apart_by_their_times(at: float, first: float, last: float, words: str) -> None:
    assert instant(at, first, last) == words
