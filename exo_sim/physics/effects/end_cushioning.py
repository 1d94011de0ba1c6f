"""A cushion that throttles what leaves near either end of the stroke."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import Applicability

EFFECT = Effect(
    name="end_cushioning",
    places=("cylinder",),
    family="cushion",
    question="Does pressure rise sharply in the shrinking chamber at one fixed distance from the end?",
    says="End cushions throttle the flow near the ends of the stroke.",
    parameters=(
        Parameter("length", "m", 1e-4, 0.2, (5e-3, 2.5e-2), "10-25 mm for 32-50 mm bores"),
        Parameter("area", "m^2", 1e-10, 1e-4, (2e-8, 1e-6), "needle, 0.01-0.1 of the port"),
    ),
    cut="gas",
    reveals=("pressure_1", "pressure_2"),
    needs=("position",),
    mistaken_for=("line_restriction", "unknown"),
    experiment="turn the cushion needle, or stop short of the end",
    convention="length is counted from the piston's ends of travel, X = 0 and X = stroke; both cushions are alike. "
    "The needle and the valve, or the hose, lie behind each other: 1/C^3 adds up.",
    valid=(
        "the cushion seal closes at once at its length and leaks nothing; where flow is not choked it lets up to 12 % too much "
        "pass."
    ),
    signature="a pressure spike tied to position; the start from the end is not slowed",
    identification=Identification(
        jerky=True,
        starts_by_reach=tuple((reach, area) for reach in (0.02, 0.06, 0.12, 0.25) for area in (0.03, 0.15)),
        open_by={"area": (0.95, 1.05)},
        applicability=Applicability(moving=True),
    ),
)


#: So far beyond the place where a cushion's seal closes a step ends that goes up to it [m].
_BEYOND = 1e-9


@kernel
def reached(p, x: float, end: float, stroke: float) -> float:
    """Return after which share of a piston's way from `x` to `end` [m] a cushion's seal closes or opens next; 1 where none does."""
    share = 1.0
    for place in (p.length, stroke - p.length):
        ahead = (place - x) / (end - x)
        if ahead > 0.0:
            share = min(share, ahead + _BEYOND / abs(end - x))
    return share


@kernel
def outlet(p, area: float, from_end: float) -> float:
    """Return the area left to gas that leaves a chamber whose piston is `from_end` metres from its end [m^2].

    Two restrictions behind each other stand for one of 1/C^3 = 1/C_1^3 + 1/C_2^3, the cubic rule for sonic conductances. Against two
    nozzles it is right within 5 % where the flow is choked; towards equal pressures it gives up to 12 % too much.
    """
    if p.length <= 0.0 or from_end >= p.length:
        return area
    narrow, wide = min(area, p.area), max(area, p.area)
    return narrow * (1.0 + (narrow / wide) ** 3) ** (-1.0 / 3.0) if narrow > 0.0 else 0.0
