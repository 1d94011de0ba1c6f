"""Gas from a chamber to the atmosphere: rod gland, fitting, porous wall."""

from __future__ import annotations

import math
from collections.abc import Mapping

from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.effects import critical_ratio
from exo_sim.physics.identification import Twins
from exo_sim.physics.settling import hot_gas, laminar_rate, path_rate
from exo_sim.physics.terms import OUTWARD_FLOW

_ORIFICE = "C = 1e-13..1e-11 m^3/(s Pa), gland to bad fitting"
_POROUS = "printed cylinders, Zillen (PMC10907517), and worn glands"

#: What drives a path from 5 bar to the atmosphere, p^2 - p_atm^2 [Pa^2].
_DRIVING = 2.4e11


def _inertial(known: Mapping[str, float]) -> dict[str, tuple[float, ...]]:
    """Return the question whether a known porous path has inertia: half of the drop to begin with, the flow from 5 bar staying."""
    paths = {name: (2.0 * value,) for name, value in known.items() if name.startswith("laminar")}
    if "inertial" in known or not paths:
        return {}
    return {**paths, "inertial": (2.0 / (max(max(values) for values in paths.values()) ** 2 * _DRIVING),)}


EFFECT = Effect(
    name="external_leakage",
    places=("cylinder",),
    family="leak",
    question="With every path closed, does a chamber lose gas that the other does not gain?",
    says="Gas leaks from the cylinder to the atmosphere.",
    parameters=(
        Parameter("area_1", "m^2", 0.0, 1e-4, (1e-10, 1e-7), _ORIFICE, required=False),
        Parameter("area_2", "m^2", 0.0, 1e-4, (1e-10, 1e-7), _ORIFICE, required=False),
        Parameter("laminar_1", "kg/(s Pa^2)", 0.0, 1e-12, (1e-19, 1e-15), _POROUS, required=False),
        Parameter("laminar_2", "kg/(s Pa^2)", 0.0, 1e-12, (1e-19, 1e-15), _POROUS, required=False),
        Parameter("inertial", "Pa^2 s^2/kg^2", 0.0, 1e28, (1e18, 1e24), _POROUS, required=False),
        critical_ratio.OF_OTHER_PATHS,
    ),
    any_of=(("area_1",), ("area_2",), ("laminar_1",), ("laminar_2",)),
    cut="gas",
    reveals=("pressure_1", "pressure_2"),
    mistaken_for=("piston_leakage", "valve_null_leakage", "valve_edges", "wall_heat_transfer", "sensor_bias"),
    experiment="close every path at equal pressures and hold longer than five thermal time constants",
    convention=(
        "inertial belongs to both porous paths: p^2 - p_atm^2 = w/laminar + inertial w^2; ratio is the b of ISO 6358 of both areas, choked "
        "flow staying a nozzle's, which they are without one."
    ),
    valid=(
        "the path neither opens nor closes with pressure; an area is a sharp-edged nozzle or has a ratio of its own, laminar and inertial "
        "are a porous path."
    ),
    signature="one chamber falls towards the atmosphere and never rests above it; the other does not rise",
    identification=Identification(
        proportional=True,
        leaks=0.5,
        twins=Twins(in_one_chamber=("piston_leakage",)),
        open_by={"laminar_1": (0.9, 1.9), "laminar_2": (0.9, 1.9)},  # an inertial part too small to show makes the path look narrower
        closed_by="inertial",
        forms=(
            ("area_1",),
            ("area_2",),
            ("laminar_1",),
            ("laminar_2",),
            ("area_1", "area_2"),
            ("laminar_1", "laminar_2"),
            ("laminar_1", "inertial"),
            ("laminar_2", "inertial"),
            ("laminar_1", "laminar_2", "inertial"),
        ),
        further={
            (*areas, "ratio"): {"ratio": critical_ratio.BEGUN_OF_OTHER_PATHS}
            for areas in (("area_1",), ("area_2",), ("area_1", "area_2"))
        },
        known={"ratio": critical_ratio.KNOWN_OF_OTHER_PATHS},
        neutral={"ratio": critical_ratio.NOZZLE},
        left_open=(_inertial,),
    ),
)


@OUTWARD_FLOW.of(EFFECT)
def outward(p, here, there, world):
    """Return the mass flow from a chamber to the atmosphere [kg/s].

    An orifice by the law of ISO 6358, and a porous path after Forchheimer, p^2 - p_atm^2 = w/a + b w^2, signed.
    """
    area = p.area_1 if here.side == 1 else p.area_2
    laminar = p.laminar_1 if here.side == 1 else p.laminar_2
    leaked = critical_ratio.path_flow(p.ratio, area, here.p, here.t, world.atmosphere, world.ambient, world.k, world.r)
    if laminar > 0.0:
        drop = here.p * here.p - world.atmosphere * world.atmosphere
        resistance = 1.0 / laminar
        leaked += 2.0 * drop / (resistance + math.sqrt(resistance * resistance + 4.0 * p.inertial * abs(drop)))
    return leaked


@OUTWARD_FLOW.settling(EFFECT)
def settling(p, here, there, span, world):
    """Return a bound on how fast a chamber settles through both paths [1/s]; inertia only slows it."""
    area = p.area_1 if here.side == 1 else p.area_2
    laminar = p.laminar_1 if here.side == 1 else p.laminar_2
    orifice = path_rate(area, here.p, world.atmosphere, here.volume, span, hot_gas(world.k, world.r))
    return orifice + laminar_rate(laminar, here.p, here.volume, world.k, world.r)
