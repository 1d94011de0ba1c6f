"""A valve that answers late: dead time, then first order."""

from __future__ import annotations

import math
from collections.abc import Mapping

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter


def _check(place: str, parameters: Mapping[str, float], curves: Mapping[str, tuple[float, ...]]) -> str:
    """Return what is wrong with the values together, "" where nothing is: without a time constant there is none to be longer."""
    lacks = "closing_excess" in parameters and parameters.get("time_constant", 0.0) <= 0.0
    return "closing_excess is a share of time_constant; give that as well, or leave closing_excess out" if lacks else ""


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
        Parameter(
            "closing_excess", "1", -0.9, 9.0, (-0.3, 1.2),
            "time to close over time to open, less one: a solenoid works against its spring and the pressure one way only "
            "(doi 10.1177/0020294019866853); 0.4-1.2 of valves whose data sheets give both (estimate)", required=False,
        ),
    ),
    any_of=(("time_constant",), ("delay",)),
    check=_check,
    cut="gas",
    needs_valve=True,
    reveals=("pressure_1", "pressure_2"),
    needs=("valve_command",),
    mistaken_for=("sensor_delay", "spool_rate_limit", "line_restriction"),
    experiment="lock the rod and step the command by two sizes; chirp it: a delay turns the phase in proportion to frequency",
    convention=(
        "the command first waits for the delay, then the spool follows it in first order; a rate limit comes "
        "after that. On its way back to the centre the spool follows with (1 + closing_excess) time_constant, away from it, and on from "
        "the centre where it passes it, with time_constant. The delay is the same both ways."
    ),
    valid=(
        "steps of every size take as long, without a closing_excess up and down; no overshoot: a spool on a spring shows one above its own "
        "frequency."
    ),
    signature="onset of dP/dt rounded and late, in proportion to nothing but time",
    identification=Identification(
        # a good proportional valve answers at about 100 Hz
        proportional=True,
        forms=(("time_constant",), ("delay",), ("time_constant", "delay")),
        further={
            ("time_constant", "closing_excess"): {"closing_excess": (0.6, -0.3)},
            ("time_constant", "delay", "closing_excess"): {"time_constant": (5e-3, 5e-3), "closing_excess": (0.6, -0.3)},
        },
        healthy={"time_constant": (1e-3, 3e-3), "delay": (1e-3, 3e-3)},
        least={"time_constant": 3e-3},
        left_open={"closing_excess": (0.6, -0.3)},
        adds_up=True,
    ),
)


@kernel
def follow(p, spool: float, command: float, h: float) -> float:
    """Return the spool after `h` seconds of a held command: exact for first order, the centre at 0."""
    if p.time_constant <= 0.0:
        return command
    if p.closing_excess != 0.0 and (command - spool) * spool < 0.0:
        return _back(spool, command, h, p.time_constant, (1.0 + p.closing_excess) * p.time_constant)
    return command + (spool - command) * math.exp(-h / p.time_constant)


@kernel
def _back(spool: float, command: float, h: float, away: float, back: float) -> float:
    """Return the spool after `h` seconds on its way back to the centre, and beyond it where the command lies there.

    Args:
        away, back: Time constants away from the centre and towards it [s].
    """
    if command * spool < 0.0:
        to_centre = back * math.log(1.0 - spool / command)
        if h > to_centre:
            return command - command * math.exp(-(h - to_centre) / away)
    return command + (spool - command) * math.exp(-h / back)
