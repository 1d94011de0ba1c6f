"""From valve command to the areas of the four metering edges."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel


@kernel
def path_areas(opening_1: float, opening_2: float, area: float, closed_area: float) -> tuple[float, float, float, float]:
    """Return the areas supply->1, 1->exhaust, supply->2, 2->exhaust [m^2].

    An opening of +1 opens its chamber to the supply, -1 to the exhaust, 0 closes both. The spool of a 4-way valve opens chamber 2
    the opposite way of chamber 1: `opening_2` is then -`opening_1`.

    Args:
        opening_1, opening_2: -1 to 1; beyond that they are held.
        area: Effective throat area of one path at full opening [m^2].
        closed_area: What every path leaks through besides, open or closed [m^2]; 0 for the paper's valve.
    """
    fed_1, let_off_1 = area * min(max(opening_1, 0.0), 1.0), area * min(max(-opening_1, 0.0), 1.0)
    fed_2, let_off_2 = area * min(max(opening_2, 0.0), 1.0), area * min(max(-opening_2, 0.0), 1.0)
    return fed_1 + closed_area, let_off_1 + closed_area, fed_2 + closed_area, let_off_2 + closed_area
