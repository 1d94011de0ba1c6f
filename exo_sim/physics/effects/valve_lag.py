"""A valve that answers late: dead time, then first order, or second where the spool has mass."""

from __future__ import annotations

import math
from collections.abc import Mapping

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter

#: How a spool gets straight from one side to the other: over its centre, to which springs move it, or one way by a spring alone.
REVERSALS = ("spring_centred", "spring_return")

#: A spool this near to critical damping is taken to be critically damped: share of the square of its decay rate.
_CRITICAL = 1e-8


def _check(place: str, parameters: Mapping[str, float], curves: Mapping[str, tuple[float, ...]]) -> str:
    """Return what is wrong with the values together, "" where nothing is: without a time constant there is none to be shaped."""
    lacking = [name for name in ("closing_excess", "inertia") if parameters.get(name) and parameters.get("time_constant", 0.0) <= 0.0]
    if lacking:
        return f"{lacking[0]} shapes time_constant; give that as well, or leave {lacking[0]} out"
    if "reversal" in parameters and not parameters.get("closing_delay"):
        return "reversal says which way a closing_delay is waited for; give that as well, or leave reversal out"
    return ""


def _closing_of_another_length(known: Mapping[str, float]) -> dict[str, tuple[float, ...]]:
    """Return the question whether a known lag closes in another time than it opens."""
    return {"closing_excess": (0.6, -0.3)} if "time_constant" in known and "closing_excess" not in known else {}


def _closing_later(known: Mapping[str, float]) -> dict[str, tuple[float, ...]]:
    """Return the question whether a valve with a known dead time is let go later or earlier than it is moved."""
    return {"closing_delay": (2e-3, -1e-3)} if "delay" in known and "closing_delay" not in known else {}


def _of_second_order(known: Mapping[str, float]) -> dict[str, tuple[float, ...]]:
    """Return the question whether a known lag is of second order: one of first order and a dead time say it badly, but late by as much."""
    late = known.get("time_constant", 0.0) + known.get("delay", 0.0)
    if "inertia" in known:
        return {}
    return {"time_constant": (late, 0.6 * late), "delay": (0.0, 0.4 * late), "inertia": (0.4, 0.4)}


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
            "closing_delay", "s", -0.1, 0.1, (-5e-3, 1.5e-2),
            "dead time when a valve closes, less that when it opens: 1-10 ms of switched solenoids whose data sheets give both (estimate)",
            required=False,
        ),
        Parameter(
            "reversal", "1", 0, 1, (0, 1), "5/3 double solenoid valves, spring-centred; 5/2 single solenoid valves with spring return",
            required=False, choices=REVERSALS, shapes="closing_delay", by_reversals=True,
        ),
        Parameter(
            "closing_excess", "1", -0.9, 9.0, (-0.3, 1.2),
            "time to close over time to open, less one: a solenoid works against its spring and the pressure one way only "
            "(doi 10.1177/0020294019866853); 0.4-1.2 of valves whose data sheets give both (estimate)", required=False,
        ),
        Parameter(
            "inertia", "1", 0.0, 25.0, (0.2, 1.0),
            "mass times stiffness over damping squared, 1/(4 z^2) of a damping ratio z: 0.5-1.1 in data sheets of proportional valves "
            "(estimate)", required=False,
        ),
    ),
    any_of=(("time_constant",), ("delay",), ("closing_delay",)),
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
        "the centre where it passes it, with time_constant. A command that goes back to the centre waits for closing_delay as well; "
        "none arrives before it is given. Straight from one side to the other a spring-centred spool stays until its solenoid has let go, "
        "and is at its centre meanwhile where that is before the other one pulls. One with a spring return, plus where its solenoid is "
        "energised and minus where it is not, closes from plus to minus alone; of one that is energised at minus turn the sign of the "
        "command. "
        "With an inertia the spool is of second order, "
        "inertia T^2 x'' + T x' + x = u with T = time_constant: its damping ratio is 1/(2 sqrt(inertia)), its natural frequency "
        "1/(2 pi T sqrt(inertia)); full opening is where it stops."
    ),
    valid=(
        "steps of every size take as long, and as long up as down without a closing_excess and a closing_delay; beside a closing_delay no "
        "command is held for less than it, and no spool stays where it is without a solenoid (bistable valves do); without an inertia no "
        "overshoot: a spool on a spring has one above its own frequency."
    ),
    signature="onset of dP/dt rounded and late, in proportion to nothing but time",
    identification=Identification(
        # a good proportional valve answers at about 100 Hz
        proportional=True,
        forms=(("time_constant",), ("delay",), ("time_constant", "delay")),
        further={
            ("time_constant", "closing_excess"): {"closing_excess": (0.6, -0.3)},
            ("time_constant", "delay", "closing_excess"): {"time_constant": (5e-3, 5e-3), "closing_excess": (0.6, -0.3)},
            ("delay", "closing_delay"): {"closing_delay": (2e-3, -1e-3)},
            ("time_constant", "delay", "closing_delay"): {"time_constant": (1e-3, 1e-3), "closing_delay": (2e-3, -1e-3)},
            ("time_constant", "inertia"): {"inertia": (0.5,)},
            ("time_constant", "delay", "inertia"): {"time_constant": (5e-3,), "inertia": (0.5,)},
        },
        switched={("delay", "closing_delay"): {"delay": (4e-3, 4e-3, 1e-2), "closing_delay": (3e-3, -2e-3, 5e-3)}},
        healthy={"time_constant": (1e-3, 3e-3), "delay": (1e-3, 3e-3)},
        least={"time_constant": 3e-3},
        adds_up=True,
        left_open=(_closing_of_another_length, _closing_later, _of_second_order),
    ),
)


@kernel
def let_go_after(p) -> float:
    """Return after what time a command arrives that closes the valve [s]."""
    return max(p.delay + p.closing_delay, 0.0)


@kernel
def arrived(prompt: float, let_go: float, closing_delay: float, reversal: float) -> float:
    """Return the command that has arrived, of that after the delay and that after delay and closing delay: the wider while it closes later.

    Straight from one side to the other it is the old one until its solenoid lets go, and none until the other pulls; of a valve with
    spring return only from plus to minus closes it.

    Args:
        prompt, let_go: Commands after the delay, and after both.
        closing_delay: [s].
        reversal: How the spool gets straight from one side to the other, of `REVERSALS`.
    """
    if prompt * let_go < 0.0:
        if reversal > 0.0:
            return max(prompt, let_go) if closing_delay > 0.0 else min(prompt, let_go)
        return let_go if closing_delay > 0.0 else 0.0
    wider = abs(let_go) > abs(prompt)
    return let_go if wider == (closing_delay > 0.0) else prompt


@kernel
def all_arrived(prompt, let_go, closing_delay: float, reversal: float, out) -> None:
    """Write the commands that have arrived (`arrived`), of arrays of one shape, (n, m)."""
    for i in range(prompt.shape[0]):
        for j in range(prompt.shape[1]):
            out[i, j] = arrived(prompt[i, j], let_go[i, j], closing_delay, reversal)


@kernel
def follow(p, spool: float, speed: float, command: float, h: float) -> tuple[float, float]:
    """Return place and speed of the spool after `h` seconds of a held command: exact, the centre at 0.

    The speed is 0 without an inertia.
    """
    if p.time_constant <= 0.0:
        return command, 0.0
    closes = p.closing_excess != 0.0 and (command - spool) * spool < 0.0
    back = (1.0 + p.closing_excess) * p.time_constant
    if p.inertia > 0.0:
        return _with_mass(spool, speed, command, h, back if closes else p.time_constant, p.inertia)
    if closes:
        return _back(spool, command, h, p.time_constant, back), 0.0
    return command + (spool - command) * math.exp(-h / p.time_constant), 0.0


@kernel
def _with_mass(spool: float, speed: float, command: float, h: float, time_constant: float, inertia: float) -> tuple[float, float]:
    """Return place and speed of a spool of second order after `h` seconds; it stops where it is fully open.

    Args:
        time_constant: T of inertia T^2 x'' + T x' + x = u [s].
        inertia: Of that equation.
    """
    stiff = 1.0 / (inertia * time_constant * time_constant)
    decay = 0.5 / (inertia * time_constant)
    apart = decay * decay - stiff
    off = spool - command
    if apart > _CRITICAL * decay * decay:
        root = math.sqrt(apart)
        slow, fast = -stiff / (decay + root), -(decay + root)
        early, late = math.exp(fast * h), math.exp(slow * h)
        one, other = (speed - fast * off) / (slow - fast), (speed - slow * off) / (slow - fast)
        place, moves = one * late - other * early, slow * one * late - fast * other * early
    else:
        root = math.sqrt(max(-apart, 0.0))
        turned = root * h
        along, across = math.cos(turned), (math.sin(turned) / root if root > _CRITICAL * decay else h)
        left = math.exp(-decay * h)
        place = left * (off * along + (speed + decay * off) * across)
        moves = left * (speed * along - (stiff * off + decay * speed) * across)
    if abs(command + place) > 1.0:
        return math.copysign(1.0, command + place), 0.0
    return command + place, moves


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
