"""Gas past the piston seal, from one chamber to the other."""

from __future__ import annotations

import math
from collections.abc import Mapping

from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.effects import critical_ratio
from exo_sim.physics.identification import Applicability
from exo_sim.physics.settling import hot_gas, laminar_rate, path_rate
from exo_sim.physics.terms import ACROSS_FLOW

#: Area of an orifice over the conductance of a laminar gap that lets as much air past from 6 to 3 bar, at 20 degrees [Pa s/m].
_ORIFICE_OVER_GAP = 1.9e8


def _by_both_laws(known: Mapping[str, float]) -> dict[str, tuple[float, ...]]:
    """Return the question whether a known leak is in part of the other law: half of it to begin with."""
    area, laminar = known.get("area", 0.0), known.get("laminar", 0.0)
    if area > 0.0 and laminar > 0.0:
        return {}
    whole = area or laminar * _ORIFICE_OVER_GAP
    return {"area": (0.5 * whole,), "laminar": (0.5 * whole / _ORIFICE_OVER_GAP,)}


EFFECT = Effect(
    name="piston_leakage",
    places=("cylinder",),
    family="leak",
    question="With every path closed, does one chamber lose what the other gains?",
    says="Gas leaks past the piston from the fuller chamber to the other.",
    parameters=(
        Parameter(
            "area",
            "m^2",
            0.0,
            1e-4,
            (1e-10, 1e-7),
            "ISO 10099 order for new seals, a hundredfold for worn ones",
            required=False,
        ),
        Parameter(
            "laminar", "kg/(s Pa^2)", 0.0, 1e-12, (1e-19, 1e-15), "pi D c^3/(24 mu R T l), c 1-15 um", required=False
        ),
        critical_ratio.OF_OTHER_PATHS,
    ),
    any_of=(("area",), ("laminar",)),
    cut="gas",
    reveals=("pressure_1", "pressure_2"),
    mistaken_for=("valve_null_leakage", "external_leakage", "valve_edges", "wall_heat_transfer"),
    experiment="block both ports at the cylinder and hold, once with equal and once with unequal pressures",
    convention=(
        "+ or - is by pressure; area is an orifice, laminar a gap: w = laminar (p1^2 - p2^2). ratio is the b of ISO 6358 of the orifice, "
        "choked flow staying a nozzle's, which it is without one. In a single-acting cylinder chamber 2 is the atmosphere."
    ),
    valid=(
        "the path neither opens nor closes with pressure, place or direction; an area is a sharp-edged nozzle or has a ratio of its own, "
        "laminar a gap without inertia."
    ),
    signature="closed chambers converge; nothing happens at equal pressures",
    # where chamber 2 is the atmosphere it is an external one
    identification=Identification(
        proportional=True,
        leaks=1.0,
        forms=(("area",), ("laminar",)),
        open_by={"area": (1.0, 1.2)},  # both chambers are near each other, where a way with a critical ratio of 0.3 passes 17 % less
        closed_by="ratio",
        further={("area", "ratio"): {"ratio": critical_ratio.BEGUN_OF_OTHER_PATHS}},
        known={"ratio": critical_ratio.KNOWN_OF_OTHER_PATHS},
        neutral={"ratio": critical_ratio.NOZZLE},
        left_open=(_by_both_laws,),
        applicability=Applicability(two_chambers=True),
    ),
)


@ACROSS_FLOW.of(EFFECT)
def across(p, one, two, world):
    """Return the mass flow from chamber 1 to 2 [kg/s]: an orifice, a laminar gap w = a (p1^2 - p2^2), or both."""
    orifice = critical_ratio.path_flow(p.ratio, p.area, one.p, one.t, two.p, two.t, world.k, world.r)
    return orifice + p.laminar * (one.p * one.p - two.p * two.p)


@ACROSS_FLOW.settling(EFFECT)
def settling(p, here, there, span, world):
    """Return a bound on how fast a chamber settles through both paths [1/s].

    Gershgorin's: scaled with the roots of the volumes, the other chamber answers with a / sqrt(V V').
    """
    orifice = path_rate(p.area, here.p, there.p, here.volume, span, hot_gas(world.k, world.r))
    gap = laminar_rate(p.laminar, max(here.p, there.p), here.volume, world.k, world.r)
    return (orifice + gap) * (1.0 + math.sqrt(here.volume / there.volume))
