"""What the form of the gas's equations leaves open of its numbers."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import benches
import pytest

from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.policy.off_nominal import AREA_FORM, HEAT_FORM, HOSE_AREA_FORM, HOSE_FORM, LAG_FORM, VOLUME_FORM
from exo_sim.diagnosis.subsystems.gas.form_errors import error_of_form
from exo_sim.machine.rig_model import load
from exo_sim.simulation.plugin import PneumaticPlugin


@pytest.fixture
def plant(tmp_path: Path) -> PlantParameters:
    rig = benches.bench(tmp_path)
    gas = PneumaticPlugin(load(rig), rig).pneumatics
    return PlantParameters(gas.world, gas.cylinders)


def factor(effect: str, name: str) -> FreeParameter:
    return FreeParameter(effect, "piston", name, "1", Target.FACTOR, 0.1, 0.05, 10.0, (1.0, 0.1), neutral=1.0)


def with_hose(plant: PlantParameters, volume: float) -> PlantParameters:
    cylinder = plant.cylinder.copy()
    cylinder["line_restriction"]["area"], cylinder["line_restriction"]["volume"] = 1e-5, volume
    return replace(plant, cylinder=cylinder)


@pytest.mark.parametrize("side", [1, 2])
def test_a_dead_volume_is_known_to_a_share_of_the_whole_chamber(plant: PlantParameters, side: int) -> None:
    c = plant.cylinder[0]
    dead = float(c[f"dead_volume_{side}"])
    middle = dead + 0.5 * float(c["stroke"]) * float(c[f"area_{side}"])
    assert error_of_form(factor("dead_volume", f"dead_volume_{side}"), plant, plant) == pytest.approx(VOLUME_FORM * middle / dead)


def test_beside_a_hose_neither_volume_is_known_to_less_than_a_share_of_its_own(plant: PlantParameters) -> None:
    hosed, dead = with_hose(plant, 4e-5), float(plant.cylinder["dead_volume_1"][0])
    alone = error_of_form(factor("dead_volume", "dead_volume_1"), plant, plant)
    beside = error_of_form(factor("dead_volume", "dead_volume_1"), hosed, plant)
    assert beside == pytest.approx(math.hypot(alone, HOSE_FORM * 4e-5 / dead))
    volume = FreeParameter("line_restriction", "piston", "volume", "m^3", Target.CYLINDER, 1e-5, 0.0, 1e-3)
    assert error_of_form(volume, hosed, plant) == pytest.approx(HOSE_FORM * 4e-5)


def test_an_area_is_known_to_a_share_and_what_nobody_looked_at_to_what_the_data_say(plant: PlantParameters) -> None:
    assert error_of_form(factor("flow_capacity", "valve_area"), plant, plant) == AREA_FORM
    leak = FreeParameter("piston_leakage", "piston", "area", "m^2", Target.CYLINDER, 1e-8, 0.0, 1e-6)
    assert error_of_form(leak, plant, plant) == 0.0


@pytest.mark.parametrize(
    ("overlaps", "shift", "open_by"),
    [((0.004, -0.004, -0.004, 0.004), 0.03, 0.004), ((0.004, 0.004, 0.004, 0.004), 0.03, 0.0), ((0.004, -0.004, -0.004, 0.004), 0.0, 0.0)],
    ids=["a shift in the edges", "a dead band in them", "edges alone"],
)  # fmt: skip
def test_what_of_a_shift_stands_in_the_edges_is_known_of_neither(
    plant: PlantParameters, overlaps: tuple[float, ...], shift: float, open_by: float
) -> None:
    names = [f"overlap_{edge}" for edge in ("supply_1", "exhaust_1", "supply_2", "exhaust_2")]
    cylinder = plant.cylinder.copy()
    cylinder["valve_offset"]["shift"] = shift
    for name, value in zip(names, overlaps, strict=True):
        cylinder["valve_edges"][name] = value
    fitted = replace(plant, cylinder=cylinder)
    numbers = [("valve_offset", "shift"), *(("valve_edges", name) for name in names)]
    asked = [FreeParameter(effect, "piston", name, "1", Target.CYLINDER, 0.01, -0.5, 0.5) for effect, name in numbers]
    assert [error_of_form(one, fitted, plant) for one in asked] == pytest.approx([open_by] * 5)
    excess = FreeParameter("valve_edges", "piston", "excess_supply_1", "1", Target.CYLINDER, 0.05, -0.5, 0.5)
    assert error_of_form(excess, fitted, plant) == 0.0


def test_heat_to_the_wall_is_known_to_a_share_and_beside_a_hose_to_a_larger_one(plant: PlantParameters) -> None:
    conductance = FreeParameter("wall_heat_transfer", "piston", "conductance", "W/K", Target.CYLINDER, 0.2, 0.0, 100.0)
    cylinder = plant.cylinder.copy()
    cylinder["wall_heat_transfer"]["conductance"] = 0.5
    warm = replace(plant, cylinder=cylinder)
    assert error_of_form(conductance, warm, plant) == pytest.approx(0.5 * HEAT_FORM)
    assert error_of_form(replace(conductance, prior=(0.5, 0.1)), warm, plant) == 0.0  # the owner's, whose law counts elsewhere
    assert error_of_form(conductance, with_hose(warm, 4e-5), plant) == pytest.approx(0.5 * math.hypot(HEAT_FORM, HOSE_FORM))


def test_of_a_chamber_without_dead_volume_nothing_is_left_open(plant: PlantParameters) -> None:
    """There is nothing that a factor could stand for, as in chamber 2 of a single-acting cylinder."""
    cylinder = plant.cylinder.copy()
    cylinder["dead_volume_2"] = 0.0
    bare = replace(plant, cylinder=cylinder)
    assert error_of_form(factor("dead_volume", "dead_volume_2"), bare, bare) == 0.0


def test_a_hose_that_was_found_is_known_to_a_share_of_its_area(plant: PlantParameters) -> None:
    area = FreeParameter("line_restriction", "piston", "area", "m^2", Target.CYLINDER, 1e-5, 0.0, 1e-3)
    assert error_of_form(area, with_hose(plant, 4e-5), plant) == pytest.approx(HOSE_AREA_FORM * 1e-5)
    assert error_of_form(replace(area, prior=(1e-5, 1e-6)), with_hose(plant, 4e-5), plant) == 0.0  # the owner's


def test_how_late_a_valve_is_is_known_no_better_than_its_order_and_how_late_a_sensor_is_as_the_data_say(plant: PlantParameters) -> None:
    late = FreeParameter("valve_lag", "piston", "time_constant", "s", Target.CYLINDER, 5e-3, 0.0, 0.5)
    assert error_of_form(late, plant, plant) == LAG_FORM
    assert error_of_form(replace(late, prior=(0.0, 1e-3)), plant, plant) == 0.0  # of any healthy valve
    card = FreeParameter("sensor_delay", "slide.position", "seconds", "s", Target.SENSOR, 1e-3, -1.0, 1.0)
    assert error_of_form(card, plant, plant) == 0.0
