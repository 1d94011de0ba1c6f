"""A valve whose zero is not at zero command."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import Applicability, Twins

#: Overlaps that one unit of shift is worth: it opens two edges sooner and two later.
_AS_OVERLAPS = {"overlap_supply_1": -1.0, "overlap_exhaust_1": 1.0, "overlap_supply_2": 1.0, "overlap_exhaust_2": -1.0}

EFFECT = Effect(
    name="valve_offset",
    places=("cylinder",),
    family="valve",
    question="Does the valve pass gas at zero command, and less one way than the other?",
    says="The valve's zero is shifted.",
    parameters=(
        Parameter(
            "shift", "1", -0.5, 0.5, (-0.05, 0.05), "proportional valves, 0.1-0.2 V of 5 V (engineering estimate)"
        ),
    ),
    cut="gas",
    needs_valve=True,
    reveals=("pressure_1", "pressure_2"),
    needs=("valve_command",),
    mistaken_for=("valve_null_leakage", "sensor_bias"),
    experiment="lock the rod, command plus and minus the same small value",
    convention="shift is added to the spool after lag and hysteresis and before the dead-band.",
    valid="the shift stays over the recording: no drift with warmth or supply pressure.",
    signature="one chamber fills and the other vents at zero command",
    identification=Identification(
        applicability=Applicability(partly_open=True), proportional=True, starts=((0.01,), (-0.01,)), healthy={"shift": (5e-4, 1e-3)},
        twins=Twins(as_parts={"valve_edges": _AS_OVERLAPS}),
    ),
)


@kernel
def shifted(p, spool: float) -> float:
    """Return the spool position relative to the true zero."""
    return spool + p.shift
