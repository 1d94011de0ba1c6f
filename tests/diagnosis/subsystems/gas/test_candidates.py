"""Candidates for the gas: their bounds follow from the machine."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import cylinder_runs

from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.policy.priors import WIDEST_IN_SERIES
from exo_sim.diagnosis.subsystems.gas.candidates import candidates
from exo_sim.physics.plant_records import CYLINDER, WORLD


def test_what_is_in_series_with_the_valve_is_not_sought_much_wider_than_it() -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    plant.cylinder["valve_area"], plant.cylinder["area_1"], plant.cylinder["stroke"] = 2e-6, 8e-4, 0.2
    level = np.full(50, 3e5)
    run = cylinder_runs.run_of(level, level, command=np.linspace(-0.2, 0.2, 50), commanded=True)
    asked = candidates(plant, [run], "piston", "slide")
    areas = [q for c in asked if c.effect == "line_restriction" for q in c.parameters if q.parameter == "area"]
    assert areas and all(q.high == pytest.approx(WIDEST_IN_SERIES * 2e-6) for q in areas)


@pytest.mark.parametrize(("period", "reach"), [(1e-3, 0.05), (0.02, 0.5)])
def test_a_delay_is_sought_as_far_as_a_logger_with_this_clock_is_late_and_never_into_the_future(period: float, reach: float) -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    level = np.full(50, 3e5)
    run = cylinder_runs.run_of(level, level, time=np.arange(50) * period, length=np.linspace(0.05, 0.1, 50))
    late = [c for c in candidates(plant, [run], "piston", "slide") if c.effect == "sensor_delay"]
    assert [(c.where, c.also) for c in late] == [
        ("piston.pressure_1", ()), ("piston.pressure_2", ()), ("piston.pressure_1", ("piston.pressure_2",)), ("slide.position", ()),
    ]  # fmt: skip
    for one in late:
        (q,) = one.parameters
        assert q.high == pytest.approx(reach)
        assert -q.low == pytest.approx(q.healthy_limit)
        assert q.healthy_limit >= 0.99 * period


def test_a_hose_is_sought_where_it_is_a_part_of_the_dead_volumes_as_well() -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    plant.cylinder["valve_area"], plant.cylinder["dead_volume_1"], plant.cylinder["dead_volume_2"] = 2e-6, 4e-5, 0.0
    level = np.full(50, 3e5)
    run = cylinder_runs.run_of(level, level, command=np.linspace(-0.2, 0.2, 50), commanded=True)
    hose = next(c for c in candidates(plant, [run], "piston", "slide") if c.effect == "line_restriction")
    ((own, key, per_unit),) = hose.displaced
    assert own.parameter == "volume" and own in hose.parameters
    assert key == ("dead_volume", "piston", "dead_volume_1") and per_unit == pytest.approx(2.5e4)


def test_long_hoses_are_sought_among_those_that_the_smaller_dead_volume_may_hold() -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    plant.cylinder["valve_area"], plant.cylinder["dead_volume_1"], plant.cylinder["dead_volume_2"] = 2e-6, 4e-5, 3e-5
    level = np.full(50, 3e5)
    run = cylinder_runs.run_of(level, level, command=np.linspace(-0.2, 0.2, 50), commanded=True)
    hoses = [c for c in candidates(plant, [run], "piston", "slide") if c.effect == "line_restriction"]
    with_shapes = [c for c in hoses if c.shapes]
    forms = {tuple(q.parameter for q in c.parameters): c for c in with_shapes}
    assert set(forms) == {("area", "volume", "length"), ("area", "volume", "conductance")}
    # laminar in a tube as warm as the room: Nu = 3.66, k of air 0.026 W/(m K)
    warm = [(area, volume, heat / (3.66 * 0.026 * np.pi)) for area, volume, heat in forms["area", "volume", "conductance"].shapes]
    for (area, volume, length), within in (
        *((shape, 1e-9) for shape in forms["area", "volume", "length"].shapes), *((shape, 0.02) for shape in warm)
    ):
        assert 0.0 < volume < 3e-5
        bore = np.sqrt(4.0 * volume / (np.pi * length))
        assert area == pytest.approx(502.0 * 0.029 * bore**2 / np.sqrt(length / bore**1.25 + 510.0), rel=within)  # ISO 6358-3


@pytest.mark.parametrize(("command", "asked"), [(np.full(50, 0.8), False), (np.linspace(0.0, 0.8, 50), True), (np.zeros(50), True)])
def test_what_a_valve_shows_by_its_command_is_not_asked_of_one_that_stays_open(command: np.ndarray, asked: bool) -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    plant.cylinder["valve_area"], plant.cylinder["area_1"], plant.cylinder["stroke"] = 2e-6, 8e-4, 0.2
    level = np.full(50, 3e5)
    names = {c.effect for c in candidates(plant, [cylinder_runs.run_of(level, level, command=command, commanded=True)], "piston", "slide")}
    assert ({"line_restriction", "valve_lag", "valve_deadband", "valve_edges"} <= names) is asked
    assert {"external_leakage", "wall_heat_transfer", "exhaust_back_pressure"} <= names


@pytest.mark.parametrize(("period", "delay", "time_constant"), [(1e-3, 3e-3, 3e-3), (5e-3, 5e-3, 5e-3)])
def test_a_valve_is_late_only_beyond_what_the_card_of_a_slow_logger_is(period: float, delay: float, time_constant: float) -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    plant.cylinder["valve_area"], plant.cylinder["area_1"], plant.cylinder["stroke"] = 2e-6, 8e-4, 0.2
    level = np.full(50, 3e5)
    run = cylinder_runs.run_of(level, level, time=np.arange(50) * period, command=np.linspace(-0.2, 0.2, 50), commanded=True)
    late = [c for c in candidates(plant, [run], "piston", "slide") if c.effect == "valve_lag"]
    assert {c.form for c in late if not c.further} == {"time_constant", "delay", "time_constant+delay"}
    for q in (q for c in late for q in c.parameters if q.parameter in ("time_constant", "delay")):
        assert q.healthy_limit == pytest.approx(delay if q.parameter == "delay" else time_constant)


@pytest.mark.parametrize(
    ("ratio", "index", "asked"),
    [
        (0.0, 0.0, {("ratio", False), ("ratio+index", False)}),  # nobody said how the valve chokes: another ratio is missing physics
        (0.38, 0.0, {("index", True)}),  # the owner's b is a number of his, and what he left open of its law no finding
        (0.38, 0.55, set()),
    ],
)
def test_a_flow_law_that_the_owner_gave_is_no_missing_physics(ratio: float, index: float, asked: set[tuple[str, bool]]) -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    plant.cylinder["valve_area"], plant.cylinder["area_1"], plant.cylinder["stroke"] = 2e-6, 8e-4, 0.2
    plant.cylinder["critical_ratio"]["ratio"], plant.cylinder["critical_ratio"]["index"] = ratio, index
    level = np.full(50, 3e5)
    run = cylinder_runs.run_of(level, level, command=np.linspace(-0.2, 0.2, 50), commanded=True)
    found = [c for c in candidates(plant, [run], "piston", "slide") if c.effect == "critical_ratio"]
    assert {(c.form, c.is_law) for c in found} == asked
    assert all(q.low < value < q.high for c in found for start in c.starts for q, value in zip(c.parameters, start, strict=False))


@pytest.mark.parametrize(
    ("length", "conductance", "asked"),
    [(0.0, 0.0, "ratio+length+conductance"), (1.5, 0.0, "ratio+conductance"), (1.5, 0.4, "ratio")],
    ids=["a lump", "its length known", "its wall known too"],
)
def test_how_a_hose_goes_on_that_the_rig_has_is_asked_as_its_law(
    length: float, conductance: float, asked: str
) -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    plant.cylinder["valve_area"], plant.cylinder["area_1"], plant.cylinder["stroke"] = 2e-6, 8e-4, 0.2
    for name, value in (("area", 4e-6), ("volume", 2e-5), ("length", length), ("conductance", conductance)):
        plant.cylinder["line_restriction"][name] = value
    plant.world["exhaust_back_pressure"]["area"] = 5e-6  # a shared part leaves nothing open
    level = np.full(50, 3e5)
    run = cylinder_runs.run_of(level, level, command=np.linspace(-0.2, 0.2, 50), commanded=True)
    found = [c for c in candidates(plant, [run], "piston", "slide") if c.effect == "line_restriction"]
    assert [(c.form, c.is_law, c.fixed) for c in found] == [(asked, True, ())]  # area and volume stay what the rig says


@pytest.mark.parametrize(
    ("effect", "known", "asked"),
    [
        (
            "valve_lag", {"time_constant": 4e-3, "delay": 1e-3},
            {"closing_excess": [0.6, -0.3], "closing_delay": [2e-3, -1e-3], "time_constant+delay+inertia": [5e-3, 3e-3]},
        ),
        (  # without a time constant nothing closes in another
            "valve_lag", {"delay": 5e-3}, {"closing_delay": [2e-3, -1e-3], "time_constant+delay+inertia": [5e-3, 3e-3]},
        ),
        ("valve_lag", {"time_constant": 4e-3, "inertia": 0.4, "closing_excess": 0.2}, {}),
        ("piston_leakage", {"area": 1.9e-8}, {"area+laminar": [0.95e-8]}),
        ("piston_leakage", {"laminar": 1e-16}, {"area+laminar": [0.95e-8]}),
        ("piston_leakage", {"area": 1.9e-8, "laminar": 1e-16}, {}),
        ("external_leakage", {"laminar_1": 1e-16}, {"laminar_1+inertial": [2e-16]}),
        ("external_leakage", {"laminar_1": 1e-16, "inertial": 1e20}, {}),
        ("external_leakage", {"area_2": 1e-8}, {}),
    ],
)  # fmt: skip
def test_of_what_an_owner_knows_the_law_is_asked_where_he_left_it_open(
    effect: str, known: dict[str, float], asked: dict[str, list[float]]
) -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    plant.cylinder["valve_area"], plant.cylinder["area_1"], plant.cylinder["stroke"] = 2e-6, 8e-4, 0.2
    for name, value in known.items():
        plant.cylinder[effect][name] = value
    level = np.full(50, 3e5)
    run = cylinder_runs.run_of(level, level, command=np.linspace(-0.2, 0.2, 50), commanded=True)
    found = [c for c in candidates(plant, [run], "piston", "slide") if c.effect == effect]
    assert all(c.is_law and not c.fixed for c in found)
    assert all(q.healthy_limit == 0.0 for c in found for q in c.parameters)  # how much he has of it is no finding
    assert {c.form: pytest.approx([start[0] for start in c.starts]) for c in found} == asked


def test_what_is_asked_only_of_a_found_effect_begins_where_that_ended() -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    plant.cylinder["valve_area"], plant.cylinder["area_1"], plant.cylinder["stroke"] = 2e-6, 8e-4, 0.2
    level = np.full(50, 3e5)
    run = cylinder_runs.run_of(level, level, command=np.linspace(-0.2, 0.2, 50), commanded=True)
    found = {c.form: c for c in candidates(plant, [run], "piston", "slide") if c.effect == "valve_lag"}
    lag, closing = found["time_constant"], found["time_constant+closing_excess"]
    assert not lag.further and closing.further == {"closing_excess"}
    assert closing.parameters[0] == lag.parameters[0]  # else a fit would not begin where the other ended
    assert [start[1] for start in closing.starts] == [0.6, -0.3]


@pytest.mark.parametrize(("size", "asked"), [(1.0, False), (0.6, True)])
def test_a_valve_that_is_only_thrown_from_end_to_end_is_not_asked_what_it_does_between(size: float, asked: bool) -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    plant.cylinder["valve_area"], plant.cylinder["area_1"], plant.cylinder["stroke"] = 2e-6, 8e-4, 0.2
    level, command = np.full(50, 3e5), size * (np.arange(50) % 10 < 5)
    run = cylinder_runs.run_of(level, level, command=command, commanded=True)
    found = {one.effect: one for one in candidates(plant, [run], "piston", "slide")}
    between = {"valve_deadband", "valve_hysteresis", "valve_characteristic", "valve_offset"}
    assert (between <= set(found), bool(between & set(found))) == (asked, asked)
    assert {"valve_lag", "spool_rate_limit"} <= set(found)
    assert found["valve_edges"].prerequisite == ("valve_deadband" if asked else "")  # their sizes show at full opening
    assert found["heat_transfer_law"].prerequisite == "wall_heat_transfer"


@pytest.mark.parametrize(("command", "at_once"), [(np.arange(50) % 10 < 5, True), (np.linspace(-0.2, 0.2, 50), False)])
def test_whether_a_valve_closes_later_is_asked_at_once_where_commands_only_switch(command: np.ndarray, at_once: bool) -> None:
    plant = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    plant.cylinder["valve_area"], plant.cylinder["area_1"], plant.cylinder["stroke"] = 2e-6, 8e-4, 0.2
    level = np.full(50, 3e5)
    found = candidates(plant, [cylinder_runs.run_of(level, level, command=command.astype(float), commanded=True)], "piston", "slide")
    assert len({one.key for one in found}) == len(found)  # a set of findings names each of them once
    (closing,) = [one for one in found if one.form == "delay+closing_delay"]
    assert (not closing.further) is at_once
    assert not [one for one in found if "reversal" in one.form]  # a spring shows only where a command goes straight across
    across = np.where(np.arange(50) % 10 < 5, 1.0, -1.0)
    across[3] = 1.0 if at_once else 0.9
    run = cylinder_runs.run_of(level, level, command=across, commanded=True)
    found = candidates(plant, [run], "piston", "slide")
    (closing,) = [one for one in found if one.form == "delay+closing_delay"]
    (spring,) = [one for one in found if one.form == "delay+closing_delay,reversal=spring_return"]
    assert closing.fixed == () and [(q.parameter, value) for q, value in spring.fixed] == [("reversal", 1.0)]
    assert not [one for one in found if "reversal" in one.form and "closing_delay" not in one.form]
