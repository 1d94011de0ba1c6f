"""Gas past the piston seal, from one chamber to the other."""

from __future__ import annotations

from exo_sim.physics import gas
from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects.declaration import Asked, Effect, Parameter

EFFECT = Effect(
    name="piston_leakage",
    places=("cylinder",),
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
    ),
    any_of=(("area",), ("laminar",)),
    cut="gas",
    reveals=("pressure_1", "pressure_2"),
    mistaken_for=("valve_null_leakage", "external_leakage", "wall_heat_transfer"),
    experiment="block both ports at the cylinder and hold, once with equal and once with unequal pressures",
    convention=(
        "+ or - is by pressure; area is an orifice, laminar a gap: w = laminar (p1^2 - p2^2). In a single-"
        "acting cylinder chamber 2 is the atmosphere."
    ),
    signature="closed chambers converge; nothing happens at equal pressures",
    asked=Asked(proportional=True, leaks=1.0, forms=(("area",), ("laminar",))),
)


@kernel
def flow(p, p_1: float, t_1: float, p_2: float, t_2: float, k: float, r: float) -> float:
    """Return the mass flow from chamber 1 to 2 [kg/s]: an orifice, a laminar gap w = a (p1^2 - p2^2), or both."""
    return gas.flow(p.area, p_1, t_1, p_2, t_2, k, r) + p.laminar * (p_1 * p_1 - p_2 * p_2)
