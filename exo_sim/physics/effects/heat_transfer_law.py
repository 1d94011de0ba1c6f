"""How the heat to the wall depends on where the piston is and on the state of the gas."""

from __future__ import annotations

import math

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter

#: Gas at which the conductance of `wall_heat_transfer` is stated [Pa], [K].
PRESSURE, TEMPERATURE = 4e5, 293.15

EFFECT = Effect(
    name="heat_transfer_law",
    places=("cylinder",),
    family="wall",
    question="Does a chamber that is long or full lose its heat faster than one that is short or nearly empty?",
    says="Heat transfer to the wall grows with the exposed wall, or with the density of the gas.",
    parameters=(
        Parameter("exposure", "1", 0.0, 1.0, (0.0, 1.0), "0: one conductance; 1: one coefficient over both faces and the barrel"),
        Parameter(
            "exponent", "1", 0.0, 1.0, (0.0, 0.8), "of pressure times temperature: 0 still gas, 0.5 Eichelberg (1939), used for cylinders "
            "by Carneiro and de Almeida (2006), 0.8 turbulent", required=False,
        ),
    ),
    cut="gas",
    reveals=("pressure_1", "pressure_2"),
    mistaken_for=("wall_heat_transfer", "dead_volume", "line_restriction"),
    requires="wall_heat_transfer",
    experiment="fill fast, close every path and wait, once with the piston at either end, and at 2 and at 6 bar",
    convention=(
        "the conductance of wall_heat_transfer is multiplied by 1 + exposure (A/A_half - 1), A the wall that the gas touches (both "
        "faces and the barrel) and A_half at half stroke, and by (p T / (4 bar 293.15 K))^exponent. exposure 1 alone is one heat transfer "
        "coefficient; with exponent 0.5 it is Eichelberg's law."
    ),
    valid="neither the speed of the piston nor a jet from the port stirs the gas, and all wall of a chamber has one temperature.",
    signature="the time in which a closed chamber takes the temperature of its wall depends less on its length, or less on its pressure",
    identification=Identification(
        forms=(("exposure", "exponent"),),
        starts=((1.0, 0.0), (1.0, 0.5)),
        known={"exposure": (0.5, 0.5), "exponent": (0.25, 0.25)},
        is_law=True,
    ),
)


@kernel
def factor(p, here) -> float:
    """Return by how much the conductance between a chamber's gas and its wall differs from what is stated."""
    if p.exposure == 0.0 and p.exponent == 0.0:
        return 1.0
    barrel = 2.0 * math.sqrt(math.pi * here.bore_area)
    wall = 2.0 * here.area + barrel * max(here.depth, 0.0)
    half = 2.0 * here.area + 0.5 * barrel * here.stroke
    return (1.0 + p.exposure * (wall / half - 1.0)) * (here.p * here.t / (PRESSURE * TEMPERATURE)) ** p.exponent


@kernel
def steepest(p, here) -> float:
    """Return by how much the gas settles faster at its wall's temperature for it, at most.

    At constant volume p T grows with the square of T: gas that is warmer than its wall loses the more for each kelvin.
    """
    return factor(p, here) * (1.0 + 2.0 * p.exponent * max(1.0 - here.wall / here.t, 0.0))
