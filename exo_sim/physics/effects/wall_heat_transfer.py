"""Heat between the gas and the chamber wall."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects.declaration import Asked, Effect, Parameter

_SOURCE = "h = 10-120 W/(m^2 K) over the wall of a 12-50 mm bore; Carneiro and de Almeida (2007)"

EFFECT = Effect(
    name="wall_heat_transfer",
    places=("cylinder",),
    question="Does the pressure of a closed chamber relax to a plateau after a fast fill, and creep up after a fast vent?",
    says="The gas exchanges heat with the cylinder wall.",
    parameters=(
        Parameter("conductance", "W/K", 0.0, 1e3, (0.1, 2.0), _SOURCE, required=False),
        Parameter("conductance_1", "W/K", 0.0, 1e3, (0.1, 2.0), _SOURCE + "; chamber 1 only, on top", required=False),
        Parameter("conductance_2", "W/K", 0.0, 1e3, (0.1, 2.0), _SOURCE + "; chamber 2 only, on top", required=False),
    ),
    any_of=(("conductance",), ("conductance_1",), ("conductance_2",)),
    cut="gas",
    reveals=("pressure_1", "pressure_2"),
    mistaken_for=("external_leakage", "piston_leakage", "viscous_friction"),
    experiment="fill fast, close every path and wait ten seconds; then vent fast, close and wait: heat reverses its sign and stops",
    convention=(
        "conductance is heat transfer coefficient times area, for each chamber; conductance_1 and "
        "conductance_2 come on top of it."
    ),
    signature="after a fill the pressure relaxes to a plateau without motion; a driven sealed piston draws a loop that absorbs work",
    asked=Asked(proportional=True, forms=(("conductance",), ("conductance_1", "conductance_2"))),
)


@kernel
def heat_flow(p, chamber: int, t_wall: float, t_gas: float) -> float:
    """Return the heat into the gas of chamber 1 or 2 [W]: the Q of equation 1, Newton's law of cooling."""
    return (p.conductance + (p.conductance_1 if chamber == 1 else p.conductance_2)) * (t_wall - t_gas)
