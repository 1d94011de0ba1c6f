"""The ISO 6358 ellipse in place of the nozzle."""

from __future__ import annotations

import math

from exo_sim.physics import gas
from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects.declaration import Asked, Effect, Parameter

EFFECT = Effect(
    name="critical_ratio",
    places=("cylinder",),
    question="Is choked flow right and subsonic flow too small?",
    says="The valve chokes at another pressure ratio than a nozzle (ISO 6358).",
    parameters=(
        Parameter("ratio", "1", 0.02, 0.6, (0.15, 0.5), "ISO 6358 b of real valves, several restrictions in series"),
    ),
    cut="gas",
    needs_valve=True,
    reveals=("pressure_1", "pressure_2"),
    needs=("valve_command",),
    mistaken_for=("flow_capacity", "line_restriction", "supply_droop", "exhaust_back_pressure"),
    experiment="lock the rod, fill and vent completely at one opening: the first half gives the size, the rest the ratio",
    convention="choked flow stays the nozzle's; only the ratio at which it chokes and the subsonic curve change.",
    signature="the end of every fill, and every vent below twice the atmosphere, is slower",
    asked=Asked(starts=((0.4,), (0.25,)), least={"ratio": 0.02}),
)


@kernel
def mass_flow(p, area: float, p_up: float, t_up: float, p_down: float, k: float, r: float) -> float:
    """Return the mass flow of a valve path [kg/s]: ISO 6358 with the nozzle's choked capacity, or the nozzle where off."""
    if p.ratio <= 0.0:
        return gas.mass_flow(area, p_up, t_up, p_down, k, r)
    choked = gas.critical_flow_factor(k) * math.sqrt(k / (r * t_up)) * p_up * area
    x = p_down / p_up
    if x <= p.ratio:
        return choked
    knee = gas.LAMINAR_RATIO
    y = (min(x, knee) - p.ratio) / (1.0 - p.ratio)
    ellipse = math.sqrt(1.0 - y * y)
    return choked * ellipse if x < knee else choked * ellipse * max(1.0 - x, 0.0) / (1.0 - knee)


@kernel
def flow(p, area: float, p_a: float, t_a: float, p_b: float, t_b: float, k: float, r: float) -> float:
    """Return the mass flow of a valve path from a to b [kg/s], negative where b is upstream."""
    if area <= 0.0:
        return 0.0
    if p_a >= p_b:
        return mass_flow(p, area, p_a, t_a, p_b, k, r)
    return -mass_flow(p, area, p_b, t_b, p_a, k, r)
