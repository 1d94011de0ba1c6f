"""Where the figures of bought parts are from, which are estimates, and which gets too cold."""

from dataclasses import replace

from exo_sim.rig.catalogue import CATALOGUE
from exo_sim.rig.own_catalogue import CatalogueValve
from exo_sim.sizing.bought_parts import BoughtParts, provenance, too_cold

#: Bore 40 mm.
KNEE = CATALOGUE[7]


def test_estimates_are_called_so_and_sources_are_named():
    cylinder = replace(KNEE, standard="Maker X", source="list 7", estimated=("mass_0",), coldest=253.15)
    part = BoughtParts("knee", cylinder, CatalogueValve("Maker V1", 5e-6, 0.3, source="list 8"))
    assert provenance([part]) == [
        "knee: Maker X by list 7; estimates: mass without stroke.",
        "knee: Maker V1 by list 8; no estimates.",
    ]
    assert part.numbers() == {"cylinder": "list 7", "cylinder_estimates": ["mass_0"], "valve": "list 8", "valve_estimates": []}
    assert provenance([BoughtParts("hip", replace(cylinder, source="", estimated=()))]) == []


def test_the_standards_own_say_what_is_estimated():
    assert provenance([BoughtParts("hip", KNEE), BoughtParts("knee", KNEE)]) == [
        "hip, knee: ISO 15552 by the standard; estimates: pivot length, mass without stroke, mass by length."
    ]


def test_gas_colder_than_its_maker_allows_is_told():
    parts = [BoughtParts(name, replace(KNEE, standard="Maker X", coldest=least)) for name, least in (("hip", 253.15), ("knee", None))]
    (line,) = too_cold(parts, {"hip": 223.15, "knee": 200.0})
    assert line.startswith("hip: its gas falls to -50 C, Maker X is made for -20 C")
    assert too_cold(parts, {"hip": 260.0}) == too_cold(parts, {}) == []
