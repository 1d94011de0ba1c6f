"""A valve whose openings do not grow in proportion to its command."""

from __future__ import annotations

import math

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import Applicability

#: Power by which the bent part of an opening grows where none is given: notches and round ports near their middle.
_POWER = 2.0

EFFECT = Effect(
    name="valve_characteristic",
    places=("cylinder",),
    family="valve",
    question="Does the valve pass more, or less, at half its command than half of what it passes at full command?",
    says="The valve's openings are not in proportion to its command.",
    parameters=(
        Parameter(
            "curvature", "1", -1.0, 1.0, (-0.5, 0.7), "0 a rectangular slot; 0.3-0.8 notches and round ports that begin to open, -0.2 to "
            "-0.6 where a port is nearly free (estimate)", required=False,
        ),
        Parameter("exponent", "1", 1.2, 4.0, (1.5, 3.0), "1.3-2 round ports and notches (circle segments 1.5)", required=False),
        Parameter(
            "rounding", "1", 0.0, 0.2, (0.002, 0.02), "clearance and rounded edges, 2-10 um each, over a stroke of 0.5-2 mm: Eryilmaz, "
            "Wilson (2006)", required=False,
        ),
    ),
    any_of=(("curvature",), ("rounding",)),
    cut="gas",
    needs_valve=True,
    reveals=("pressure_1", "pressure_2"),
    needs=("valve_command",),
    mistaken_for=("flow_capacity", "valve_deadband", "valve_edges", "line_restriction"),
    experiment="lock the rod, fill and vent it at five openings between a tenth and the whole, and draw the choked flow over the command",
    convention=(
        "with d from 0 where an edge begins to open (behind valve_offset, valve_deadband and valve_edges) to 1 at full command an edge is "
        "open by (1 - curvature) d + curvature d^exponent, with an exponent of 2 where none is given: positive is progressive, negative "
        "degressive. Full opening stays at full command, so that flow_capacity counts there. With a rounding r d is first (d + sqrt(d^2 + "
        "r^2))/2: half of r is open where a sharp edge would begin, and what closes tails off."
    ),
    valid="all four edges are cut alike, and an edge passes what its opening says at any pressure.",
    signature="fills at small and at large commands ask for valves of different size; which it is does not depend on pressure",
    identification=Identification(
        applicability=Applicability(partly_open=True),
        forms=(("curvature",), ("curvature", "exponent")),
        starts=((0.3, 2.0), (-0.3, 2.0)),
        least={"curvature": 0.15},
        known={"exponent": (2.0, 0.7)},
    ),
)  # fmt: skip


@kernel
def present(p) -> bool:
    """Return whether openings differ from the paper's."""
    return p.curvature != 0.0 or p.rounding != 0.0


@kernel
def curved(p, opening: float) -> float:
    """Return how far an edge is open, 0 to 1, of its place `opening`: 0 where a sharp edge begins to open, 1 at full command."""
    if p.rounding > 0.0:
        opening = 0.5 * (opening + math.sqrt(opening * opening + p.rounding * p.rounding))
    held = min(max(opening, 0.0), 1.0)
    if p.curvature == 0.0 or held <= 0.0:
        return held
    bent = held * held if p.exponent <= 0.0 or p.exponent == _POWER else held**p.exponent
    return min(max((1.0 - p.curvature) * held + p.curvature * bent, 0.0), 1.0)
