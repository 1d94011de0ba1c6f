"""The catalogue: standard sizes, rising in everything, and what it makes of the owner's own cylinders."""

import math

import pytest

from exo_sim import rig as rigs
from exo_sim.errors import RigError
from exo_sim.rig.catalogue import CATALOGUE, RATED_PRESSURE, CatalogueCylinder, estimated_mass, find


def entry(bore: float) -> CatalogueCylinder:
    found = find(bore)
    assert found is not None
    return found


def test_bores_and_rods_of_the_standards():
    pairs = [(round(1e3 * one.bore), round(1e3 * one.rod)) for one in CATALOGUE]
    assert pairs == [(8, 4), (10, 4), (12, 6), (16, 6), (20, 8), (25, 10), (32, 12), (40, 16), (50, 20), (63, 20), (80, 25), (100, 25)]
    assert all(one.standard == ("ISO 6432" if one.bore < 0.03 else "ISO 15552") for one in CATALOGUE)
    assert RATED_PRESSURE == 1e6


def test_masses_are_to_the_scale_of_what_makers_publish():
    published = 4.49, 4.76  # SMC CP96 and C96, bore 100 and stroke 100 mm: catalogue ES20-204B
    assert published[0] < entry(0.100).mass(0.1) < published[1]
    steel = 7850.0
    for one in CATALOGUE:  # a barrel is no lighter than the rod that comes with each length of it
        assert one.mass_per_length > 1.5 * math.pi / 4 * one.rod**2 * steel


def test_larger_is_heavier_and_longer():
    for small, large in zip(CATALOGUE, CATALOGUE[1:]):
        assert small.mass(0.1) < large.mass(0.1)
        assert small.shortest(0.1) <= large.shortest(0.1)
    assert all(one.mass(0.1) < one.mass(0.2) for one in CATALOGUE)


def test_the_shortest_stroke_that_covers_a_travel():
    of_40_mm = entry(0.040)
    assert of_40_mm.stroke_for(0.100) == pytest.approx(0.100)
    assert of_40_mm.stroke_for(0.1001) == pytest.approx(0.125)
    assert of_40_mm.stroke_for(0.9) is None


def test_euler_buckling_of_a_16_mm_rod():
    # pi^2 E I / L^2 = 6.54 kN at 1 m for 206 GPa; a fifth of it is allowed
    inertia = math.pi / 64 * 0.016**4
    assert entry(0.040).buckling_force(1.0) == pytest.approx(math.pi**2 * 2.06e11 * inertia / 5.0)
    assert entry(0.040).buckling_force(0.5) == pytest.approx(4 * entry(0.040).buckling_force(1.0))


def test_mass_between_two_standard_bores(repository):
    cylinder = rigs.read(repository / "assets" / "exo_250_psi.toml").cylinders["knee_l"]
    from dataclasses import replace

    assert estimated_mass(cylinder) == pytest.approx(entry(0.040).mass(cylinder.stroke))
    odd = estimated_mass(replace(cylinder, bore=0.045))
    assert entry(0.040).mass(cylinder.stroke) < odd < entry(0.050).mass(cylinder.stroke)
    with pytest.raises(RigError, match="outside the catalogue"):
        estimated_mass(replace(cylinder, bore=0.3))
