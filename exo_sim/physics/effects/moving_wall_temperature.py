"""A wall that warms and cools with the gas."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Parameter

EFFECT = Effect(
    name="moving_wall_temperature",
    places=("cylinder",),
    family="wall",
    question="Does the heat exchange fade while the cylinder works, as if the wall came to meet the gas?",
    says="The cylinder wall itself warms and cools.",
    parameters=(
        Parameter("heat_capacity", "J/K", 0.1, 1e6, (2.0, 400.0), "0.02-0.4 kg of aluminium a chamber"),
        Parameter("outside_conductance", "W/K", 0.0, 1e3, (0.02, 1.0), "natural convection over 10-400 cm^2"),
    ),
    requires="wall_heat_transfer",
    cut="gas",
    reveals=("pressure_1", "pressure_2"),
    mistaken_for=("wall_heat_transfer",),
    experiment="repeat one fill and hold from cold, then after five minutes of work",
    convention=(
        "heat_capacity and outside_conductance are one chamber's; both chambers are alike. The outside is the"
        " environment of the rig."
    ),
    valid=(
        "the wall has one temperature throughout (thin aluminium, not plastic), and both chambers' walls do not warm each "
        "other."
    ),
    signature="the plateau after a fill drifts; the loop of a driven sealed piston shrinks over minutes",
)


@kernel
def wall_rate(p, q_gas: float, t_wall: float, t_outside: float) -> float:
    """Return dT/dt of the wall [K/s]; `q_gas` is the heat into the gas [W]. A wall without heat capacity stays put."""
    if p.heat_capacity <= 0.0:
        return 0.0
    return (-q_gas - p.outside_conductance * (t_wall - t_outside)) / p.heat_capacity
