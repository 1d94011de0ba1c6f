"""What the closed paths of the valve let through."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import Applicability

EFFECT = Effect(
    name="valve_null_leakage",
    places=("cylinder",),
    family="valve",
    question="With the command at zero, do both chambers drift to one level between supply and exhaust?",
    says="The closed paths of the valve leak.",
    parameters=(
        Parameter("area", "m^2", 0.0, 1e-4, (1e-9, 3e-7), "spool valves, 1-10 l/min at null (engineering estimate)"),
    ),
    cut="gas",
    needs_valve=True,
    reveals=("pressure_1", "pressure_2"),
    mistaken_for=("piston_leakage", "external_leakage", "valve_offset"),
    experiment="hold at zero command at two supply pressures: the level that the chambers reach scales with the supply",
    convention="each of the four paths leaks through this area, whatever it is open besides.",
    valid="all four closed paths leak alike and through nozzles; overlap or underlap of single edges is not distinguished.",
    signature="at null both pressures go to 0.75-0.85 of the supply; the supply is used at rest",
    identification=Identification(proportional=True, leaks=0.75, applicability=Applicability(commanded=True)),
)


@kernel
def closed_area(p) -> float:
    """Return the area that every path leaks through besides its opening [m^2]."""
    return p.area
