"""The flow law of ISO 6358 in place of the nozzle: critical ratio, subsonic index, cracking pressure."""

from __future__ import annotations

import math

from exo_sim.physics import nozzle
from exo_sim.physics.compiled import inlined_kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter

#: The ellipse that stands for a nozzle.
NOZZLE = 0.528

EFFECT = Effect(
    name="critical_ratio",
    places=("cylinder",),
    family="flow law",
    question="Is choked flow right and subsonic flow too small?",
    says="The valve chokes at another pressure ratio than a nozzle (ISO 6358).",
    parameters=(
        Parameter("ratio", "1", 0.02, 0.6, (0.15, 0.5), "ISO 6358 b of real valves, several restrictions in series"),
        Parameter("index", "1", 0.3, 1.0, (0.45, 0.6), "ISO 6358-1:2013 m; 0.5 is the ellipse of the first edition", required=False),
        Parameter("cracking", "Pa", 0.0, 2e5, (2e3, 3e4), "ISO 6358-1:2013; springs of check and flow-control valves", required=False),
    ),
    cut="gas",
    needs_valve=True,
    reveals=("pressure_1", "pressure_2"),
    needs=("valve_command",),
    mistaken_for=("flow_capacity", "line_restriction", "supply_droop", "exhaust_back_pressure"),
    experiment="lock the rod, fill and vent completely at one opening: the first half gives the size, the rest the ratio",
    convention=(
        "choked flow stays the nozzle's; beyond the ratio b it is multiplied by (1 - ((r - b)/(1 - cracking/p - b))^2)^index, r the "
        "ratio of downstream to upstream pressure p, with an index of 0.5 where none is given. No gas flows at a drop below cracking."
    ),
    valid=(
        "one ratio, index and cracking pressure hold at every opening, in every path and both ways through it; where the drop that "
        "opens it is nearly the whole pressure, choking gives way so that a fiftieth is left to subsonic flow."
    ),
    signature="the end of every fill, and every vent below twice the atmosphere, is slower",
    # the ellipse of 0.528 stands for the nozzle of the paper: a healthy valve may follow either
    identification=Identification(
        forms=(("ratio",), ("ratio", "index")),
        proportional=True,
        starts=((0.4, 0.5), (0.25, 0.5)),
        least={"ratio": 0.02},
        neutral={"ratio": NOZZLE, "index": 0.5},
        known={"index": (0.52, 0.04)},
        every_law=True,
    ),
)

#: The ratio of a path that is no valve's, a leak's or a silencer's; what is known of it before any data, mean and standard deviation, and
#: where fits of it begin.
OF_OTHER_PATHS = Parameter(
    "ratio", "1", 0.02, 0.6, (0.2, 0.5),
    "ISO 6358 b: 0.5 of a short sharp hole, 0.2 of several throttles in series (labyrinths, scored lips, sinter)", required=False,
)  # fmt: skip
KNOWN_OF_OTHER_PATHS = (0.35, 0.1)
BEGUN_OF_OTHER_PATHS = (KNOWN_OF_OTHER_PATHS[0],)

#: What is left to subsonic flow at least, of the range of pressure ratios.
_SUBSONIC = 0.02


@inlined_kernel
def mass_flow(p, area: float, p_up: float, t_up: float, p_down: float, k: float, r: float) -> float:
    """Return the mass flow of a valve path [kg/s]: ISO 6358 with the nozzle's choked capacity, or the nozzle where off."""
    if p.ratio <= 0.0:
        return nozzle.mass_flow(area, p_up, t_up, p_down, k, r)
    choked = nozzle.choked_flow(area, p_up, t_up, k, r)
    x = p_down / p_up
    if p.cracking > 0.0 or (p.index > 0.0 and p.index != 0.5):
        return choked * subsonic_share(x, p.ratio, p.index, p.cracking / p_up)
    return choked * ellipse(x, p.ratio)


@inlined_kernel
def ellipse(x: float, ratio: float) -> float:
    """Return the flow over choked flow at a ratio x of downstream to upstream pressure (ISO 6358:1989), linear near x = 1."""
    if x <= ratio:
        return 1.0
    knee = nozzle.LAMINAR_RATIO
    y = (min(x, knee) - ratio) / (1.0 - ratio)
    share = math.sqrt(1.0 - y * y)
    return share if x < knee else share * max(1.0 - x, 0.0) / (1.0 - knee)


@inlined_kernel
def path_flow(ratio: float, area: float, p_a: float, t_a: float, p_b: float, t_b: float, k: float, r: float) -> float:
    """Return the mass flow of a path that has its own critical ratio from a to b [kg/s], negative where b is upstream.

    By the ellipse with the nozzle's choked capacity; a nozzle's throughout where the ratio is 0.
    """
    if ratio <= 0.0:
        return nozzle.flow(area, p_a, t_a, p_b, t_b, k, r)
    if p_a >= p_b:
        return nozzle.choked_flow(area, p_a, t_a, k, r) * ellipse(p_b / p_a, ratio)
    return -nozzle.choked_flow(area, p_b, t_b, k, r) * ellipse(p_a / p_b, ratio)


@inlined_kernel
def subsonic_share(x: float, ratio: float, index: float, cracking: float) -> float:
    """Return the flow over choked flow by all four parameters (ISO 6358-1:2013), linear where the ellipse would end upright.

    Args:
        x: Downstream over upstream pressure.
        ratio, index: b, and m or 0 for 0.5.
        cracking: Cracking pressure over upstream pressure.
    """
    closes = 1.0 - cracking
    chokes = min(ratio, closes - _SUBSONIC)
    if x >= closes:
        return 0.0
    if x <= chokes:
        return 1.0
    knee = (nozzle.LAMINAR_RATIO - ratio) / (1.0 - ratio)
    y = (x - chokes) / (closes - chokes)
    held = min(y, knee)
    share = (1.0 - held * held) ** (index if index > 0.0 else 0.5)
    return share if y < knee else share * (1.0 - y) / (1.0 - knee)


@inlined_kernel
def flow(p, area: float, p_a: float, t_a: float, p_b: float, t_b: float, k: float, r: float) -> float:
    """Return the mass flow of a valve path from a to b [kg/s], negative where b is upstream."""
    if area <= 0.0:
        return 0.0
    if p_a >= p_b:
        return mass_flow(p, area, p_a, t_a, p_b, k, r)
    return -mass_flow(p, area, p_b, t_b, p_a, k, r)
