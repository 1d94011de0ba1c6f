"""Nuisance parameters of the gas: what every healthy machine shows is free in every fit, and no finding."""

from __future__ import annotations

import math

import numpy as np
import pytest

from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters
from exo_sim.diagnosis.subsystems.gas.nuisances import known_effects, nuisance_parameters
from exo_sim.physics.plant_records import CYLINDER, WORLD


def plant(conductance: float = 0.0) -> PlantParameters:
    cylinder = np.zeros(1, CYLINDER)
    cylinder["wall_heat_transfer"]["conductance"] = conductance
    return PlantParameters(np.zeros(1, WORLD), cylinder)


def free(one: PlantParameters, rests: bool, commanded: bool = False) -> dict[tuple[str, str], FreeParameter]:
    return {(q.effect, q.parameter): q for q in nuisance_parameters(one, "piston", commanded, (1, 2), rests)}


HEAT = ("wall_heat_transfer", "conductance")


@pytest.mark.parametrize("commanded", [False, True])
def test_gas_at_rest_may_warm_at_its_walls(commanded: bool) -> None:
    heat = free(plant(), rests=True, commanded=commanded)[HEAT]
    assert heat.low == 0.0 < heat.high and heat.prior is not None and heat.prior[0] == heat.neutral == 0.0
    one = plant()
    one = one.with_values([(heat, 1.5)])
    assert one.cylinder["wall_heat_transfer"]["conductance"][0] == 1.5


def test_gas_that_works_has_no_such_excuse() -> None:
    assert HEAT not in free(plant(), rests=False)


def test_walls_that_the_rig_knows_are_not_asked_twice() -> None:
    assert HEAT not in free(plant(0.7), rests=True)
    assert HEAT in {(q.effect, q.parameter) for q in known_effects(plant(0.7), "piston")}


def test_the_critical_ratio_of_a_data_sheet_is_an_estimate_as_every_number_of_the_owner_is() -> None:
    one = plant()
    assert not [q for q in known_effects(one, "piston") if q.effect == "critical_ratio"]
    one.cylinder["critical_ratio"]["ratio"] = 0.38
    (ratio,) = (q for q in known_effects(one, "piston") if q.effect == "critical_ratio")
    assert ratio.prior == (0.38, pytest.approx(0.038)) and ratio.low < 0.3 < 0.5 < ratio.high


def test_a_valve_that_nobody_commanded_has_no_free_parameter() -> None:
    names = {effect for effect, _ in free(plant(), rests=True)}
    assert names == {"dead_volume", "sensor_zero", "wall_heat_transfer"}
    assert {"flow_capacity", "valve_offset", "valve_deadband", "valve_lag"} <= {
        effect for effect, _ in free(plant(), rests=False, commanded=True)
    }


def test_the_set_pressure_is_free_where_nobody_recorded_the_supply() -> None:
    def scale(supplied: bool) -> list[FreeParameter]:
        return [q for q in nuisance_parameters(plant(), "piston", True, (1, 2), supplied=supplied) if q.effect == "set_pressure"]

    assert scale(supplied=True) == []
    (factor,) = scale(supplied=False)
    assert factor.prior is not None and factor.prior[0] == factor.neutral == 1.0
    assert plant().with_values([(factor, 0.98)]).sensors == {"supply.scale": 0.98}


def test_a_known_dead_time_is_known_no_better_than_the_clocks_are() -> None:
    late = plant(0.0)
    late.cylinder["valve_lag"]["delay"], late.cylinder["valve_lag"]["time_constant"] = 9e-3, 5e-3

    def spread(period: float) -> float:
        (one,) = (q for q in known_effects(late, "piston", period) if q.parameter == "delay")
        assert one.prior is not None and one.prior[0] == 9e-3
        return one.prior[1]

    assert math.isclose(spread(0.0), math.hypot(0.9e-3, 1e-3), rel_tol=1e-6)
    assert math.isclose(spread(5e-3), math.hypot(0.9e-3, 1e-3, 2.5e-3), rel_tol=1e-6)


@pytest.mark.parametrize(("period", "most", "spread"), [(1e-3, 3e-3, 1e-3), (5e-3, 5e-3, 2.5e-3)])
def test_the_card_of_a_slow_logger_filters_as_long_as_a_sample_takes(period: float, most: float, spread: float) -> None:
    free = nuisance_parameters(plant(), "piston", True, (1, 2), period=period)
    (dead_time,) = (q for q in free if (q.effect, q.parameter) == ("valve_lag", "delay"))
    assert (dead_time.low, dead_time.high, dead_time.prior) == (0.0, most, (0.0, spread))
    (width,) = (q for q in free if q.effect == "valve_deadband")  # which is no time
    (same,) = (q for q in nuisance_parameters(plant(), "piston", True, (1, 2)) if q.effect == "valve_deadband")
    assert width == same


def excesses(one: PlantParameters) -> dict[str, FreeParameter]:
    free_ones = (*nuisance_parameters(one, "piston", True, (1, 2)), *known_effects(one, "piston"))
    return {q.parameter: q for q in free_ones if q.effect == "valve_edges"}


@pytest.mark.parametrize(("what", "spread", "jumps"), [("excess", 0.05, False), ("overlap", 0.002, True)])
def test_no_valve_has_four_edges_of_one_size_nor_of_one_lap(what: str, spread: float, jumps: bool) -> None:
    edges = {name: q for name, q in excesses(plant()).items() if name.startswith(what)}
    assert set(edges) == {f"{what}_supply_1", f"{what}_exhaust_1", f"{what}_supply_2", f"{what}_exhaust_2"}
    assert all(q.prior == (0.0, spread) and q.nonsmooth is jumps and q.low == -q.high for q in edges.values())
    single = plant()
    single.cylinder["single_acting"] = 1.0
    assert {name for name in excesses(single) if name.startswith(what)} == {f"{what}_supply_1", f"{what}_exhaust_1"}


def test_edges_that_a_data_sheet_tells_apart_are_as_open_as_others() -> None:
    given = plant()
    given.cylinder["valve_edges"]["excess_exhaust_1"] = -0.1
    edges = excesses(given)
    assert len(edges) == 8 and edges["excess_exhaust_1"].prior == (-0.1, pytest.approx(math.hypot(0.01, 0.05)))
    assert edges["excess_supply_2"].prior == (0.0, 0.05)


def test_a_dead_time_that_a_rig_with_a_lag_leaves_out_is_free_as_it_is_without() -> None:
    slow = plant()
    slow.cylinder["valve_lag"]["time_constant"] = 4e-3
    (delay,) = (q for q in nuisance_parameters(slow, "piston", True, (1, 2)) if q.effect == "valve_lag")
    assert delay.parameter == "delay" and delay.prior == (0.0, 1e-3)
