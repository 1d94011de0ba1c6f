"""Cylinders that can be bought: bores, rods and strokes of ISO 6432 and ISO 15552, with lengths and masses.

Bores and the rating of 1 MPa are the standards' own; rods and strokes are what makers' catalogues list with them (rods: Pneumax
general catalogue, appendix A). Lengths and masses are our estimates for aluminium profile (ISO 15552) and stainless round (ISO 6432)
cylinders, taken from no standard; makers differ by 15 % and more, so a chosen cylinder is to be looked up before it is bought. Masses
are those of bare cylinders, as makers give them (trunnion, rod eye and hoses come on top), to the scale of what is published: bore 100
and stroke 100 mm weighs 4.49 and 4.76 kg (SMC CP96 and C96, catalogue ES20-204B), 4.63 kg here. What makers publish is in
`assets/catalogues`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from exo_sim.errors import RigError
from exo_sim.rig.schema import Cylinder

#: What both standards rate a cylinder for, above the atmosphere [Pa].
RATED_PRESSURE = 1.0e6

#: What the standards do not say: estimates of ours, by the words of a catalogue file.
ESTIMATED = ("pivot_length", "mass_0", "mass_per_metre")

_MM, _G_PER_10MM = 1e-3, 0.1
#: Clearance that stays at each end of the stroke, and what port and a short hose add to each chamber.
_CLEARANCE, _PORT_AND_HOSE = 5e-3, 4e-6

_SHORT = (10, 25, 40, 50, 80, 100, 125, 160, 200)
_LONG = (25, 40, 50, 80, 100, 125, 160, 200, 250, 320, 400, 500)


@dataclass(frozen=True)
class CatalogueCylinder:
    """One bore of one standard.

    Attributes:
        standard: "ISO 6432" or "ISO 15552".
        bore, rod: [m].
        strokes: Standard ones [m], rising.
        pivot_length: From a trunnion in the middle of a barrel of no stroke to the eye of the rod drawn in [m]; half the stroke
            comes on top.
        mass_without_stroke: Of the bare cylinder [kg].
        mass_per_length: [kg/m].
        rating: Largest pressure in it, absolute [Pa].
        maker: Who makes it; "" for the standard's own.
        coldest: What its maker allows [K], None where it is not known.
        source: Where its figures come from.
        estimated: Those of its figures that are estimates, by the words of a catalogue file.
    """

    standard: str
    bore: float
    rod: float
    strokes: tuple[float, ...]
    pivot_length: float
    mass_without_stroke: float
    mass_per_length: float
    rating: float = RATED_PRESSURE + 101325.0
    maker: str = ""
    coldest: float | None = None
    source: str = ""
    estimated: tuple[str, ...] = ()

    def mass(self, stroke: float) -> float:
        """Return the mass with a stroke [kg]."""
        return self.mass_without_stroke + self.mass_per_length * stroke

    def shortest(self, stroke: float) -> float:
        """Return the shortest distance between its pivots [m], held by a trunnion in the middle of the barrel."""
        return self.pivot_length + 0.5 * stroke

    def stroke_for(self, travel: float) -> float | None:
        """Return the shortest standard stroke that covers a travel, or None."""
        return next((stroke for stroke in self.strokes if stroke >= travel - 1e-9), None)

    def dead_volumes(self) -> tuple[float, float]:
        """Return what stays in chamber 1 and 2 at their ends, port and a short hose included [m^3]."""
        area = math.pi / 4 * self.bore**2
        return (
            round(area * _CLEARANCE + _PORT_AND_HOSE, 7),
            round((area - math.pi / 4 * self.rod**2) * _CLEARANCE + _PORT_AND_HOSE, 7),
        )

    def buckling_force(self, length: float) -> float:
        """Return the push at which the rod, hinged at both ends over a length, buckles, five-fold safe [N] (Euler)."""
        return math.pi**2 * 2.06e11 * math.pi / 64 * self.rod**4 / (5.0 * length**2)


def _row(
    standard: str, strokes: tuple[int, ...], bore: float, rod: float, pivot: float, grams: float, per_10mm: float
) -> CatalogueCylinder:
    return CatalogueCylinder(
        standard, bore * _MM, rod * _MM, tuple(s * _MM for s in strokes), pivot * _MM, grams * 1e-3, per_10mm * _G_PER_10MM,
        source="the standard", estimated=ESTIMATED,
    )  # fmt: skip


#: All of them by rising bore. Columns: bore, rod, pivot length [mm], mass without stroke [g], mass of 10 mm of stroke [g].
CATALOGUE: tuple[CatalogueCylinder, ...] = tuple(
    [_row("ISO 6432", _SHORT, *numbers) for numbers in (
        (8, 4, 48, 36, 2.4),
        (10, 4, 48, 40, 2.7),
        (12, 6, 60, 76, 4.0),
        (16, 6, 66, 88, 4.6),
        (20, 8, 78, 184, 7.2),
        (25, 10, 90, 248, 11.0),
    )]
    + [_row("ISO 15552", _LONG, *numbers) for numbers in (
        (32, 12, 116, 490, 23.0),
        (40, 16, 133, 770, 34.0),
        (50, 20, 154, 1240, 50.0),
        (63, 20, 162, 1690, 54.0),
        (80, 25, 187, 2810, 81.0),
        (100, 25, 197, 3720, 91.0),
    )]
)  # fmt: skip


def find(bore: float, rod: float | None = None) -> CatalogueCylinder | None:
    """Return the catalogue's cylinder of a bore (and a rod) [m], or None where no standard has it."""
    for entry in CATALOGUE:
        if math.isclose(entry.bore, bore, abs_tol=1e-6) and (rod is None or math.isclose(entry.rod, rod, abs_tol=1e-6)):
            return entry
    return None


def estimated_mass(cylinder: Cylinder) -> float:
    """Return the mass of any cylinder [kg]: the catalogue's, or between its neighbours' where the bore is no standard one.

    Raises:
        RigError: a bore outside the catalogue.
    """
    exact = find(cylinder.bore)
    if exact is not None:
        return exact.mass(cylinder.stroke)
    smaller = [entry for entry in CATALOGUE if entry.bore < cylinder.bore]
    larger = [entry for entry in CATALOGUE if entry.bore > cylinder.bore]
    if not smaller or not larger:
        raise RigError(
            f"bore {cylinder.bore * 1e3:g} mm is outside the catalogue "
            f"({CATALOGUE[0].bore * 1e3:g} to {CATALOGUE[-1].bore * 1e3:g} mm), so its mass is not known"
        )
    low, high = smaller[-1], larger[0]
    share = math.log(cylinder.bore / low.bore) / math.log(high.bore / low.bore)
    return math.exp((1 - share) * math.log(low.mass(cylinder.stroke)) + share * math.log(high.mass(cylinder.stroke)))
