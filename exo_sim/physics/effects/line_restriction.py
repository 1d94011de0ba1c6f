"""A hose between valve and chamber."""

from __future__ import annotations

from exo_sim.physics import nozzle
from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.effects import critical_ratio
from exo_sim.physics.identification import Applicability

EFFECT = Effect(
    name="line_restriction",
    places=("cylinder",),
    family="line",
    question="Do valve end and cylinder end of the hose differ in pressure while gas flows?",
    says="The hose between valve and cylinder throttles the flow.",
    parameters=(
        Parameter(
            "area", "m^2", 1e-8, 1e-3, (2e-6, 3e-5),
            "502 Pa s/m times C = 0.029 D^2/sqrt(L/D^1.25 + 510) in m^3/(s Pa), D and L in m, for 3-8 mm hoses of 0.3-2 m",
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
            "ratio", "1", 0.02, 0.6, (0.2, 0.5), "b = 474 C/D^2 (ISO 6358; C in m^3/(s Pa), D in m): 0.24-0.55 for the same hoses",
            required=False,
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
    convention=(
        "the hose's volume comes on top of the dead volumes of the rig; both hoses are alike. ratio is the b of ISO 6358, choked flow "
        "staying that of a nozzle of this area; without one it is a nozzle throughout."
    ),
    valid=(
        "the hose is shorter than a twentieth of the wave (2 m up to 8 Hz): one node, no delay, no heat. As a nozzle (b = 0.528) it "
        "passes 17 % more at a pressure ratio of 0.8 than the b = 0.3 of a long hose does."
    ),
    signature="flow saturates at large openings; a sensor at the valve jumps when the flow starts and stops",
    identification=Identification(
        forms=(("area", "volume"), ("area", "volume", "ratio")),
        starts_by_valve=((2.0, 5e-6, 0.36), (0.6, 1e-5, 0.36), (0.25, 5e-6, 0.36)),
        of_dead_volume="volume",
        known={"ratio": (0.36, 0.08)},
        applicability=Applicability(bursts=False),  # it delays and does not ring
    ),
)


@kernel
def present(p) -> bool:
    """Return whether there is a hose at all."""
    return p.area > 0.0


@kernel
def flow(p, area: float, p_a: float, t_a: float, p_b: float, t_b: float, k: float, r: float) -> float:
    """Return the mass flow through the hose's throttle from a to b [kg/s], negative where b is upstream.

    `area` is the throttle's as a cushion leaves it.
    """
    if p.ratio <= 0.0:
        return nozzle.flow(area, p_a, t_a, p_b, t_b, k, r)
    if p_a >= p_b:
        return nozzle.choked_flow(area, p_a, t_a, k, r) * critical_ratio.ellipse(p_b / p_a, p.ratio)
    return -nozzle.choked_flow(area, p_b, t_b, k, r) * critical_ratio.ellipse(p_a / p_b, p.ratio)
