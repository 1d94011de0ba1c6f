"""From valve command to the areas of the four metering edges."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel


@kernel
def path_areas(opening: float, area: float, closed_area: float) -> tuple[float, float, float, float]:
    """Return the areas supply->1, 1->exhaust, supply->2, 2->exhaust [m^2].

    +1 opens supply to chamber 1 and chamber 2 to the exhaust, -1 the reverse; 0 closes all four.

    Args:
        opening: -1 to 1; beyond that it is held.
        area: Effective throat area of one path at full opening [m^2].
        closed_area: What every path leaks through besides, open or closed [m^2]; 0 for the paper's valve.
    """
    forward = area * min(max(opening, 0.0), 1.0)
    backward = area * min(max(-opening, 0.0), 1.0)
    return forward + closed_area, backward + closed_area, backward + closed_area, forward + closed_area
