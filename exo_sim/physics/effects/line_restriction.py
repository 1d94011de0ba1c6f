"""A hose between valve and chamber."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects.declaration import Asked, Effect, Parameter

EFFECT = Effect(
    name="line_restriction",
    places=("cylinder",),
    question="Do valve end and cylinder end of the hose differ in pressure while gas flows?",
    says="The hose between valve and cylinder throttles the flow.",
    parameters=(
        Parameter(
            "area", "m^2", 1e-8, 1e-3, (2e-6, 3e-5), "C = 0.029 D^2/sqrt(L/D^1.25 + 510) for 3-8 mm hoses of 0.3-2 m"
        ),
        Parameter(
            "volume",
            "m^3",
            1e-7,
            1e-3,
            (2e-6, 5e-5),
            "12.6 cm^3/m (4 mm), 28.3 cm^3/m (6 mm)",
            required=False,
            default=5e-6,
        ),
        Parameter(
            "sensor", "1", 0, 1, (0, 1), "where the pressure sensors sit", required=False, choices=("chamber", "valve")
        ),
    ),
    cut="gas",
    reveals=("pressure_1", "pressure_2"),
    needs=("valve_command",),
    mistaken_for=("flow_capacity", "critical_ratio", "valve_lag", "dead_volume"),
    experiment="measure the pressure at both ends of the hose during a fill, or double its length",
    convention="the hose's volume comes on top of the dead volumes of the rig; both hoses are alike.",
    signature="flow saturates at large openings; a sensor at the valve jumps when the flow starts and stops",
    asked=Asked(forms=(("area", "volume"),), starts_by_valve=((2.0, 5e-6), (0.6, 1e-5), (0.25, 5e-6))),
)


@kernel
def present(p) -> bool:
    """Say whether there is a hose at all."""
    return p.area > 0.0
