"""What a recording shows and nobody has a name for: a curve fitted to it."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from exo_sim.physics.compiled import inlined_kernel, kernel
from exo_sim.physics.declaration import Effect, Parameter
from exo_sim.physics.settling import HOT
from exo_sim.physics.terms import DRY_FRICTION, OUTWARD_FLOW

#: The most knots that a curve may have.
KNOTS = 16

ACTS = ("force", "flow_1", "flow_2", "friction")
FRICTION = ACTS.index("friction")
DEPENDS_ON = ("position", "velocity", "pressure_1", "pressure_2", "pressure_difference")

_SOURCE = "fitted to a recording"


def _check(place: str, numbers: Mapping[str, float], curves: Mapping[str, tuple[float, ...]]) -> str:
    """Return what is wrong with the curve, or ""."""
    at, values = curves["at"], curves["values"]
    if len(at) != len(values):
        return f"at has {len(at)} entries and values {len(values)}: give one value for each"
    if any(later <= earlier for earlier, later in pairwise(at)):
        return "at must increase from entry to entry"
    acts, variable = ACTS[int(numbers["acts"])], DEPENDS_ON[int(numbers["depends_on"])]
    if place == "joint" and (acts not in ("force", "friction") or variable not in ("position", "velocity")):
        unknown = variable if acts in ("force", "friction") else acts
        return f'a joint knows no {unknown}: there acts = "force" or "friction", and depends_on position or velocity'
    return ""


EFFECT = Effect(
    name="unknown",
    places=("cylinder", "joint"),
    family="unknown",
    question="Is a force or a flow missing that follows one signal and fits no effect of this list?",
    says="Something without a name acts; a curve describes it.",
    parameters=(
        Parameter("acts", "1", 0, 3, (0, 3), "+ pushes out (a joint: along +), fills the chamber, or resists", choices=ACTS),
        Parameter("depends_on", "1", 0, 4, (0, 4), "position and velocity of the part it acts on", choices=DEPENDS_ON),
        Parameter(
            "at", "m", -1e9, 1e9, (0.0, 1.0), _SOURCE, most=KNOTS,
            unit_by=("depends_on", (("m", "rad"), ("m/s", "rad/s"), ("Pa", "Pa"), ("Pa", "Pa"), ("Pa", "Pa"))),
        ),
        Parameter(
            "values", "N", -1e9, 1e9, (-100.0, 100.0), _SOURCE, most=KNOTS,
            unit_by=("acts", (("N", "N*m"), ("kg/s", "kg/s"), ("kg/s", "kg/s"), ("N", "N*m"))),
        ),
    ),
    check=_check,
    cut="any",
    reveals=("pressure_1", "pressure_2", "position", "force"),
    mistaken_for=(),
    experiment="move that one signal alone, slowly and then fast, and look whether the curve stays",
    convention=(
        "force: + pushes the rod out, or the joint along +. flow: + fills the chamber with gas of the "
        "environment's temperature. friction: dry, in addition to the other dry friction; - takes away of that. "
        "Position is the piston's X, or the joint's coordinate. Beyond its ends the curve keeps its last value."
    ),
    valid="the signal stays within the curve's ends, and nothing else of the machine's state matters.",
    signature="what is left unexplained is a function of one signal",
)  # fmt: skip


@kernel
def present(p) -> bool:
    """Return whether there is a curve at all."""
    return p.at[KNOTS - 1] > p.at[0]


@inlined_kernel
def curve(p, variable: float) -> float:
    """Return the curve between its knots; beyond them it keeps its last value."""
    if variable <= p.at[0]:
        return p.values[0]
    for i in range(1, KNOTS):
        if variable < p.at[i]:
            share = (variable - p.at[i - 1]) / (p.at[i] - p.at[i - 1])
            return p.values[i - 1] + (p.values[i] - p.values[i - 1]) * share
    return p.values[KNOTS - 1]


@inlined_kernel
def acting(p, on: int, x: float, v: float, p_1: float, p_2: float) -> float:
    """Return the force on a part [N or N m] (on = 0), or the flow into chamber 1 or 2 [kg/s] (on = 1, 2)."""
    if not present(p) or int(p.acts) != on:
        return 0.0
    return _of_signals(p, x, v, p_1, p_2)


@inlined_kernel
def _of_signals(p, x: float, v: float, p_1: float, p_2: float) -> float:
    """Return the curve at the signal that it depends on."""
    if p.depends_on == 0.0:
        return curve(p, x)
    if p.depends_on == 1.0:
        return curve(p, v)
    if p.depends_on == 2.0:
        return curve(p, p_1)
    if p.depends_on == 3.0:
        return curve(p, p_2)
    return curve(p, p_1 - p_2)


@DRY_FRICTION.of(EFFECT)
def level(p, motion):
    """Return what is added to the dry friction [N or N m]."""
    if not present(p) or int(p.acts) != FRICTION:
        return 0.0
    return _of_signals(p, motion.x, motion.v, motion.gauge_1, motion.gauge_2)


@OUTWARD_FLOW.of(EFFECT)
def outward(p, here, there, world):
    """Return the flow from a chamber to the surroundings [kg/s]: the curve's with the sign turned."""
    p_1, p_2 = (here.p, there.p) if here.side == 1 else (there.p, here.p)
    return -acting(p, here.side, here.x, here.v, p_1, p_2)


@OUTWARD_FLOW.settling(EFFECT)
def settling(p, here, there, span, world):
    """Return how fast a chamber settles by the steepest stretch of a curve that depends on its own pressure [1/s]."""
    if not present(p) or int(p.acts) == 0 or int(p.acts) == FRICTION or p.depends_on < 2.0:
        return 0.0
    steepest = 0.0
    for i in range(1, KNOTS):
        if p.at[i] > p.at[i - 1]:
            steepest = max(steepest, abs(p.values[i] - p.values[i - 1]) / (p.at[i] - p.at[i - 1]))
    return steepest * world.k * world.r * HOT / here.volume
