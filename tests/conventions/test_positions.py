"""Whether a velocity belongs to a position as it stands: then a change of unit concerns both."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from exo_sim.conventions.positions import is_rate_of

TIME: NDArray[np.float64] = np.asarray(np.arange(6000) * 1e-3, dtype=np.float64)
PLACE, SPEED = np.sin(3.0 * TIME), 3.0 * np.cos(3.0 * TIME)


@pytest.mark.parametrize(("factor", "belongs"), [(1.0, True), (1.3, True), (1e3, False), (1e-3, False), (-1.0, False)])
def test_a_velocity_in_another_unit_is_another_s(factor: float, belongs: bool) -> None:
    assert is_rate_of(factor * SPEED, PLACE, TIME) is belongs


def test_samples_that_are_missing_do_not_matter() -> None:
    place = PLACE.copy()
    place[100:200] = np.nan
    assert is_rate_of(SPEED, place, TIME)


def test_of_what_stands_still_nothing_is_the_rate() -> None:
    assert not is_rate_of(0.0 * SPEED, 0.0 * PLACE, TIME)
