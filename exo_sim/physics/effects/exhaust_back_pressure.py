"""A silencer or a shared exhaust that throttles what leaves."""

from __future__ import annotations

from exo_sim.physics.compiled import inlined_kernel, kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.effects import critical_ratio
from exo_sim.physics.identification import Applicability

EFFECT = Effect(
    name="exhaust_back_pressure",
    places=("exhaust",),
    family="exhaust",
    question="Does a venting chamber stop above the atmosphere while gas flows, and does another cylinder's vent lift it?",
    says="The exhaust builds up pressure while gas leaves.",
    parameters=(
        Parameter(
            "area", "m^2", 1e-8, 1e-3, (2e-6, 3e-5), "felt where the silencer is less than three times the valve"
        ),
        Parameter(
            "volume", "m^3", 1e-6, 1e-2, (5e-6, 1e-4), "manifold and silencer body", required=False, default=2e-5
        ),
        critical_ratio.OF_OTHER_PATHS,
    ),
    cut="gas",
    reveals=("pressure_1", "pressure_2", "exhaust.pressure"),
    mistaken_for=("critical_ratio", "line_restriction", "sensor_bias"),
    experiment="take the silencer off, or record the exhaust pressure",
    convention=(
        "one manifold for all cylinders; area is that of the way out of it, ratio its b of ISO 6358, choked flow staying a nozzle's, "
        "which it is without one."
    ),
    valid=(
        "the manifold is short (a metre takes sound 3 ms), mixed and without heat from its wall; without a ratio the silencer throttles "
        "like a nozzle: a porous one falls below that towards equal pressures."
    ),
    signature="the floor of a venting chamber rises with the flow and is gone at rest",
    identification=Identification(
        forms=(("area",),),
        starts_by_valve={"area": (3.0, 1.0, 0.5, 0.25, 0.12, 0.06, 0.03)},
        # Towards equal pressures, where a silencer works, one with a critical ratio of 0.3 passes 17 % less than a nozzle of its area:
        # three of three on machines of other laws were found 3, 7 and 16 % too small, by more than their intervals.
        open_by={"area": (1.0, 1.2)},
        closed_by="ratio",
        further={("area", "ratio"): {"ratio": critical_ratio.BEGUN_OF_OTHER_PATHS}},
        known={"ratio": critical_ratio.KNOWN_OF_OTHER_PATHS},
        neutral={"ratio": critical_ratio.NOZZLE},
        applicability=Applicability(commanded=True),
    ),
)


@kernel
def present(p) -> bool:
    """Return whether anything stands between the valves and the open exhaust."""
    return p.area > 0.0


@inlined_kernel
def flow(p, p_node: float, t_node: float, p_out: float, t_out: float, k: float, r: float) -> float:
    """Return the mass flow from the exhaust manifold to the outside [kg/s]."""
    return critical_ratio.path_flow(p.ratio, p.area, p_node, t_node, p_out, t_out, k, r)
