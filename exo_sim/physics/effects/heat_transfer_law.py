"""How the heat to the wall depends on where the piston is and on the state of the gas."""

from __future__ import annotations

import math

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter

#: Gas at which the conductance of `wall_heat_transfer` is stated [Pa], [K].
PRESSURE, TEMPERATURE = 4e5, 293.15

#: Speed of the gas at which it is stated where moving gas loses more [m/s], and the power of the speed: turbulent flow along a wall.
SPEED, TURBULENT = 0.1, 0.8

#: Gas stirs no more than at this speed [m/s]: a jet that would fill a chamber faster strikes a part of its wall only.
FASTEST = 3.0

EFFECT = Effect(
    name="heat_transfer_law",
    places=("cylinder",),
    family="wall",
    question="Does a chamber that is long or full, or whose gas moves, lose its heat faster than one that is short, empty or at rest?",
    says="Heat transfer to the wall grows with the exposed wall, with the density of the gas, or with its speed.",
    parameters=(
        Parameter(
            "exposure", "1", 0.0, 1.0, (0.0, 1.0), "0: one conductance; 1: one coefficient over both faces and the barrel", required=False
        ),
        Parameter(
            "exponent", "1", 0.0, 1.0, (0.0, 0.8), "of pressure times temperature: 0 still gas, 0.5 Eichelberg (1939), used for cylinders "
            "by Carneiro and de Almeida (2006), 0.8 turbulent", required=False,
        ),
        Parameter(
            "stirring", "1", 0.0, 1.0, (0.0, 0.9), "share that grows with speed: quiet gas 10-40 W/(m^2 K), behind a moving piston 40-120, "
            "while a jet fills the chamber 200-300 (estimate)", required=False,
        ),
    ),
    any_of=(("exposure",), ("exponent",), ("stirring",)),
    cut="gas",
    reveals=("pressure_1", "pressure_2"),
    mistaken_for=("wall_heat_transfer", "dead_volume", "line_restriction"),
    requires="wall_heat_transfer",
    experiment="fill fast, close every path and wait, once with the piston at either end, and at 2 and at 6 bar; push the sealed piston "
    "slowly and fast",
    convention=(
        "the conductance of wall_heat_transfer is multiplied by 1 + exposure (A/A_half - 1), A the wall that the gas touches (both "
        "faces and the barrel) and A_half at half stroke, by (p T / (4 bar 293.15 K))^exponent, and by 1 - stirring + "
        "stirring (v / 0.1 m/s)^0.8, v the speed of the piston and that at which the gas which flows in fills the bore, at most 3 m/s. "
        "exposure 1 alone is one heat transfer coefficient; with exponent 0.5 it is Eichelberg's law."
    ),
    valid="all wall of a chamber has one temperature, and gas that has come to rest is as quiet at once as it will be.",
    signature="the time in which a closed chamber takes the temperature of its wall depends less on its length, or less on its pressure; "
    "gas that moves takes it sooner",
    identification=Identification(
        forms=(("exposure", "exponent", "stirring"),),
        starts=((1.0, 0.0, 0.0), (1.0, 0.5, 0.5)),
        known={"exposure": (0.5, 0.5), "exponent": (0.25, 0.25), "stirring": (0.0, 0.5)},
        is_law=True,
    ),
)


@kernel
def factor(p, here, filling: float, r: float) -> float:
    """Return by how much the conductance between a chamber's gas and its wall differs from what is stated.

    Args:
        p: Numbers of this law.
        here: The `Chamber`.
        filling: Mass flow into it [kg/s].
        r: Gas constant [J/(kg K)].
    """
    if p.exposure == 0.0 and p.exponent == 0.0 and p.stirring == 0.0:
        return 1.0
    found = _of_still_gas(p, here)
    if p.stirring > 0.0:
        speed = abs(here.speed) + max(filling, 0.0) * r * here.t / (here.p * here.area)
        found *= _stirred(p, min(speed, FASTEST))
    return found


@kernel
def _of_still_gas(p, here) -> float:
    barrel = 2.0 * math.sqrt(math.pi * here.bore_area)
    wall = 2.0 * here.area + barrel * max(here.depth, 0.0)
    half = 2.0 * here.area + 0.5 * barrel * here.stroke
    return (1.0 + p.exposure * (wall / half - 1.0)) * (here.p * here.t / (PRESSURE * TEMPERATURE)) ** p.exponent


@kernel
def _stirred(p, speed: float) -> float:
    """Return by how much gas that moves at this speed exchanges more heat than at `SPEED`."""
    return 1.0 - p.stirring + p.stirring * (speed / SPEED) ** TURBULENT


@kernel
def steepest(p, here) -> float:
    """Return by how much the gas settles faster at its wall's temperature for it, at most.

    At constant volume p T grows with the square of T: gas that is warmer than its wall loses the more for each kelvin. How fast it
    flows in is not known here: it is stirred as much as any gas is.
    """
    most = 1.0 if p.stirring == 0.0 else max(_stirred(p, FASTEST), 1.0)
    return most * _of_still_gas(p, here) * (1.0 + 2.0 * p.exponent * max(1.0 - here.wall / here.t, 0.0))
