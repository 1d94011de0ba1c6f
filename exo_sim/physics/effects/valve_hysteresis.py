"""A valve whose opening depends on where the command came from."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import Applicability

EFFECT = Effect(
    name="valve_hysteresis",
    places=("cylinder",),
    family="valve",
    question="Does the same command give another flow on the way up than on the way down, at any rate?",
    says="The valve has hysteresis.",
    parameters=(
        Parameter("width", "1", 0.0, 0.9, (0.003, 0.07), "0.3-0.4 % position-controlled, 3-7 % open-loop spools"),
    ),
    cut="gas",
    needs_valve=True,
    reveals=("pressure_1", "pressure_2"),
    needs=("valve_command",),
    mistaken_for=("valve_deadband", "valve_lag", "backlash"),
    experiment="lock the rod and loop the command slowly between different turning points",
    convention=(
        "width is that of the whole loop, in units of command, from -1 to 1. What holds the spool is where the spool is: a command that is "
        "over before a slow spool followed it leaves no trace."
    ),
    valid="the loop has one width at every command and rate, turning points leave no trace (play, not Preisach).",
    signature="flow against command is a loop of constant width, whatever the rate",
    identification=Identification(
        applicability=Applicability(partly_open=True), jerky=True, starts=((0.005,), (0.012,), (0.025,), (0.05,), (0.1,)),
        least={"width": 0.0025},
    ),
)


@kernel
def held(p, spool: float, command: float) -> float:
    """Return where a spool goes that its friction holds while the command is within half of the loop's `width` of it."""
    half = 0.5 * p.width
    return min(max(spool, command - half), command + half)
