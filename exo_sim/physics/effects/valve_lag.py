"""A valve that answers late: dead time, then first order."""

from __future__ import annotations

import math

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter

EFFECT = Effect(
    name="valve_lag",
    places=("cylinder",),
    family="valve",
    question="Does the pressure answer the command late, by the same time at every size of step?",
    says="The valve follows its command with a lag.",
    parameters=(
        Parameter(
            "time_constant", "s", 0.0, 0.5, (1e-3, 3e-2), "3-5 ms proportional, 5-20 ms solenoid valves", required=False
        ),
        Parameter("delay", "s", 0.0, 0.1, (5e-4, 2e-2), "electronics and coil", required=False),
    ),
    any_of=(("time_constant",), ("delay",)),
    cut="gas",
    needs_valve=True,
    reveals=("pressure_1", "pressure_2"),
    needs=("valve_command",),
    mistaken_for=("sensor_delay", "spool_rate_limit", "line_restriction"),
    experiment="lock the rod and step the command by two sizes; chirp it: a delay turns the phase in proportion to frequency",
    convention=(
        "the command first waits for the delay, then the spool follows it in first order; a rate limit comes "
        "after that."
    ),
    valid="steps up and down and of every size take as long; no overshoot: a spool on a spring shows one above its own frequency.",
    signature="onset of dP/dt rounded and late, in proportion to nothing but time",
    identification=Identification(
        # a good proportional valve answers at about 100 Hz
        proportional=True,
        forms=(("time_constant",), ("delay",), ("time_constant", "delay")),
        healthy={"time_constant": (1e-3, 3e-3), "delay": (1e-3, 3e-3)},
        least={"time_constant": 3e-3},
        adds_up=True,
    ),
)


@kernel
def follow(p, spool: float, command: float, h: float) -> float:
    """Return the spool after `h` seconds of a held command: exact for first order."""
    if p.time_constant <= 0.0:
        return command
    return command + (spool - command) * math.exp(-h / p.time_constant)
