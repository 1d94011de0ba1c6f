"""From openings to the areas of the four metering edges."""

from __future__ import annotations

import pytest

from exo_sim.physics.valve_areas import path_areas


@pytest.mark.parametrize(
    ("one", "two", "areas"),
    [
        (1.0, -1.0, (5, 0, 0, 5)),
        (-0.4, 0.4, (0, 2, 2, 0)),
        (0.0, 0.0, (0, 0, 0, 0)),
        (3.0, -3.0, (5, 0, 0, 5)),
        (0.5, 0.5, (2.5, 0, 2.5, 0)),
    ],
)
def test_each_chamber_is_open_to_the_supply_or_the_exhaust_and_never_to_both(one: float, two: float, areas: tuple[float, ...]) -> None:
    assert path_areas(one, two, 5.0, 0.0) == pytest.approx(areas)
    assert path_areas(one, two, 5.0, 0.1) == pytest.approx([area + 0.1 for area in areas])
