"""A valve that needs some command before it opens."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import Applicability

EFFECT = Effect(
    name="valve_deadband",
    places=("cylinder",),
    family="valve",
    question="Do small commands of either sign move no gas?",
    says="The valve does not open until the command exceeds a dead-band.",
    parameters=(
        Parameter("width", "1", 0.0, 0.9, (0.005, 0.15), "0-1 % zero lap, 2-5 % overlap, 13 % Enfield LS-V25s"),
    ),
    cut="gas",
    needs_valve=True,
    reveals=("pressure_1", "pressure_2"),
    needs=("valve_command",),
    mistaken_for=("flow_capacity", "valve_hysteresis", "coulomb_friction", "backlash"),
    experiment="lock the rod and ramp the command slowly through zero at two openings",
    convention=(
        "width is counted from zero to either side; full opening stays at full command: opening = (|u| - "
        "width)/(1 - width)."
    ),
    valid="overlap is the same on both sides, flow beyond it goes with the command, and supply and exhaust edges open together.",
    signature="the command crosses zero without an answer in pressure; flow starts at the width",
    identification=Identification(
        applicability=Applicability(partly_open=True), jerky=True, starts=((0.01,), (0.025,), (0.05,), (0.1,)),
        healthy={"width": (1e-3, 2.5e-3)},
    ),
)


@kernel
def opening(p, command: float) -> float:
    """Return the relative opening, sat((|u| - width)/(1 - width)) with the sign of u."""
    if p.width <= 0.0:
        return command
    magnitude = max(abs(command) - p.width, 0.0) / (1.0 - p.width)
    return magnitude if command > 0.0 else -magnitude
