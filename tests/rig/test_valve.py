"""Valves in a rig: one area or four, ISO 6358, overlaps, independent edges; what cannot be is refused in one line."""

import numpy as np
import pytest
from benches import bench

from exo_sim import rig as rigs
from exo_sim.errors import RigError
from exo_sim.physics import nodes
from exo_sim.physics.effects.critical_ratio import ellipse
from exo_sim.physics.nozzle import choked_flow
from exo_sim.rig import assembly
from exo_sim.rig.improved_text import Correction
from exo_sim.rig.valve import area_of


def with_valve(folder, valve):
    rig = bench(folder)
    return rigs.parse(rig.text.replace('area = "2 mm^2"', valve), rig.path)


def numbers(rig, name):
    effect = rig.effect(name, "piston")
    assert effect is not None
    return effect.parameters


def areas(rig, one, two):
    return np.array(nodes.path_areas(assembly.cylinders(rig)[0], one, two)) * 1e6


def test_a_plain_valve_is_the_papers_and_has_no_effects(tmp_path):
    rig = bench(tmp_path)
    assert rig.effects == () and rig.cylinders["piston"].commands == ("valve_command",)
    assert with_valve(tmp_path, 'kind = "4-way"\narea = "2 mm^2"').cylinders == rig.cylinders


def test_conductance_passes_what_iso_6358_says():
    """C = 1 dm^3/(s bar): at 7 bar and 293.15 K, 7 dm^3/s ANR, 1.185 g each."""
    assert choked_flow(area_of(1e-8), 7e5, 293.15, 1.4, 287.05) == pytest.approx(7e-3 * 1.185, rel=1e-9)


def test_four_areas_stand_for_four_edges(tmp_path):
    rig = with_valve(
        tmp_path,
        'kind = "independent"\narea_supply_1 = "4 mm^2"\narea_exhaust_1 = "6 mm^2"\narea_supply_2 = "3 mm^2"\narea_exhaust_2 = "5 mm^2"',
    )
    assert rig.cylinders["piston"].valve_area == pytest.approx(6e-6)
    assert areas(rig, 1.0, -1.0) == pytest.approx([4.0, 0.0, 0.0, 5.0])
    assert areas(rig, -0.5, 0.5) == pytest.approx([0.0, 3.0, 1.5, 0.0])
    assert areas(rig, 1.0, 1.0) == pytest.approx([4.0, 0.0, 3.0, 0.0])


def test_one_area_with_one_edge_of_its_own_and_overlaps(tmp_path):
    rig = with_valve(tmp_path, 'area = "2 mm^2"\narea_exhaust_2 = "1 mm^2"\noverlap_supply_1 = 0.1')
    assert areas(rig, 0.55, -0.55) == pytest.approx([1.0, 0.0, 0.0, 0.55])


def test_c_and_b_stand_in_place_of_an_area(tmp_path):
    rig = with_valve(tmp_path, 'C = "1 dm^3/(s bar)"\nb = 0.3')
    assert rig.cylinders["piston"].valve_area == pytest.approx(area_of(1e-8))
    assert numbers(rig, "critical_ratio") == {"ratio": 0.3}
    mixed = with_valve(tmp_path, 'area = "2 mm^2"\nC_supply_1 = "0.2 dm^3/(s bar)"')
    assert areas(mixed, 1.0, -1.0) == pytest.approx([1e6 * area_of(2e-9), 0.0, 0.0, 2.0])


def test_numbers_of_an_effects_table_go_before_the_valves(tmp_path):
    text = with_valve(tmp_path, 'area = "2 mm^2"\noverlap_supply_1 = 0.1\noverlap_exhaust_1 = 0.05')
    rig = rigs.parse(text.text + "[effects.valve_edges.piston]\noverlap_supply_1 = 0.02\n", text.path)
    found = numbers(rig, "valve_edges")
    assert (found["overlap_supply_1"], found["overlap_exhaust_1"]) == (0.02, 0.05)


@pytest.mark.parametrize(
    ("valve", "words"),
    [
        ('kind = "independant"\narea = "2 mm^2"', 'did you mean "independent"'),
        ('kind = "independent"\narea_supply_1 = "2 mm^2"', "area_exhaust_1 is missing"),
        ('kind = "independent"', "valve.area is missing"),
        ('area = "2 mm^2"\nC = "1 dm^3/(s bar)"', "says the same as area"),
        ('area = "2 mm^2"\nb = 0.9', "b = 0.9"),
        ('area = "2 mm^2"\nb_supply_1 = 0.3\nb_exhaust_1 = 0.2', "give one b"),
        ('area = "2 mm^2"\noverlap_suply_1 = 0.1', 'did you mean "overlap_supply_1"'),
        ('C = "1 mm^2"', "not a unit of this kind"),
        ('area = "3.6e-06 mm^2"', "a hole of 1.9 um"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(tmp_path, valve, words):
    with pytest.raises(RigError) as caught:
        with_valve(tmp_path, valve)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_corrected_area_is_written_to_the_keys_that_say_it(tmp_path):
    edges = 'area_supply_1 = "4 mm^2"\nC_exhaust_1 = "1 dm^3/(s bar)"\narea_supply_2 = "3 mm^2"\narea_exhaust_2 = "5 mm^2"'
    rig = with_valve(tmp_path, edges)
    believed = rig.cylinders["piston"].valve_area
    text = rigs.improved(rig, [], [Correction(("cylinders", "piston", "valve", "area"), 0.5 * believed, "m^2")], tmp_path)
    again = rigs.parse(text, rig.path)
    assert areas(again, 1.0, -1.0) == pytest.approx(0.5 * areas(rig, 1.0, -1.0))
    assert areas(again, -1.0, 1.0) == pytest.approx(0.5 * areas(rig, -1.0, 1.0))


@pytest.mark.parametrize(("b", "litres_per_minute"), [(0.2, 240.0), (0.3, 255.0), (0.4, 272.0)])
def test_a_catalogue_s_nominal_flow_of_a_conductance_of_one(b: float, litres_per_minute: float) -> None:
    """What docs/rig_reference.md says of 1 dm^3/(s bar) from 6 to 5 bar gauge, by ISO 6358."""
    inlet, outlet = 7.01325, 6.01325
    assert 60.0 * inlet * ellipse(outlet / inlet, b) == pytest.approx(litres_per_minute, rel=3e-3)
