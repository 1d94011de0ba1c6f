"""Heat between the gas and the chamber wall."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.settling import thermal_rate
from exo_sim.physics.terms import HEAT_FLOW

_SOURCE = "h = 10-120 W/(m^2 K) over the wall of a 12-50 mm bore; Carneiro and de Almeida (2007)"

EFFECT = Effect(
    name="wall_heat_transfer",
    places=("cylinder",),
    family="wall",
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
    valid=(
        "the exposed wall hardly changes: one conductance for any place of the piston, pressure and speed, unless the rig has "
        "heat_transfer_law too. Against a constant coefficient times the exposed area a sealed chamber of a knee drive is 7 to 9 % off "
        "in pressure, against Eichelberg's law 0.7 to 1.3 %."
    ),
    signature="after a fill the pressure relaxes to a plateau without motion; a driven sealed piston draws a loop that absorbs work",
    identification=Identification(
        proportional=True,
        wall_heat=1.0,
        forms=(("conductance",), ("conductance_1", "conductance_2")),
        counts_from={
            "heat_transfer_law": "It is stated at half of the stroke, at 4 bar and, as far as moving gas exchanges more, at 0.1 m/s: see "
            "heat_transfer_law in improved.toml.",
        },
    ),
)


@kernel
def conductance(p, side: int) -> float:
    """Return the conductance between the gas of chamber 1 or 2 and its wall [W/K]."""
    return p.conductance + (p.conductance_1 if side == 1 else p.conductance_2)


@HEAT_FLOW.of(EFFECT)
def heat_flow(p, here, world):
    """Return the heat into the gas of a chamber [W]: the Q of equation 1, Newton's law of cooling."""
    return conductance(p, here.side) * (here.wall - here.t)


@HEAT_FLOW.settling(EFFECT)
def settling(p, here, world):
    """Return how fast the gas takes the temperature of its wall [1/s]."""
    return thermal_rate(conductance(p, here.side), here.p, here.volume, world.k)
