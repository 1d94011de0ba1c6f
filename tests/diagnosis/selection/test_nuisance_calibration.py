"""Nominal numbers that are off become findings: the two dead volumes of one cylinder are one, of two cylinders two."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import cylinder_runs
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.policy.off_nominal import GAIN_SHARE, SURE
from exo_sim.diagnosis.policy.probability import CALIBRATED, UNTESTED
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.nuisance_calibration import (
    Deviation,
    calibration_findings,
    counted_back,
    deviations,
    refitted_besides,
)
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.physics.plant_records import CYLINDER, WORLD


def gas(*sides: bool) -> GasModel:
    """Return the gas of a cylinder of which these chambers were recorded."""
    steady = np.full(400, 3e5)
    run = cylinder_runs.run_of(*(steady if there else None for there in sides))
    cylinder = np.zeros(1, CYLINDER)
    cylinder["area_1"], cylinder["area_2"], cylinder["stroke"] = 1e-3, 1e-3, 0.2
    return GasModel([run], PlantParameters(np.zeros(1, WORLD), cylinder), Split({}))


def test_the_dead_volume_of_a_chamber_that_nobody_recorded_is_not_observed() -> None:
    for seen in ((True, False), (False, True), (True, True)):
        assert [gas(*seen).is_observed(volume(side)) for side in (1, 2)] == list(seen)
    assert gas(True, False).is_observed(number("flow_capacity", "piston", "valve_area"))


FACTORS = st.floats(0.3, 3.0)
ERRORS = st.floats(1e-4, 0.1)


def number(effect: str, where: str, field: str) -> FreeParameter:
    return FreeParameter(effect, where, field, "1", Target.FACTOR, 0.1, 0.05, 10.0, (1.0, 0.15), neutral=1.0)


def volume(side: int, where: str = "piston") -> FreeParameter:
    return number("dead_volume", where, f"dead_volume_{side}")


@given(one=FACTORS, other=FACTORS, error=ERRORS, doubt=ERRORS)
def test_two_dead_volumes_are_one_finding_between_them(one: float, other: float, error: float, doubt: float) -> None:
    (found,) = calibration_findings([Deviation(volume(1), one, error), Deviation(volume(2), other, doubt)])
    assert (found.name, found.where, found.kind) == ("dead_volume", "piston", "calibration")
    factor = found.parameters["factor"]
    low, high = min(one, other), max(one, other)
    assert low - 1e-12 <= factor.value <= high + 1e-12
    assert factor.low <= low + 1e-12 and high - 1e-12 <= factor.high
    assert (found.parameters["dead_volume_1"].value, found.parameters["dead_volume_2"].value) == (one, other)


@pytest.mark.parametrize(
    ("effect", "factor", "error", "beyond"),
    [
        ("dead_volume", 1.4, 0.01, False),
        ("dead_volume", 1.8, 0.01, True),
        ("dead_volume", 1.8, 0.2, False),  # it may be less
        ("flow_capacity", 0.4, 0.01, True),
        ("payload_mass", 2.5, 0.01, False),  # nobody but the owner says what he put on
    ],
)
def test_a_number_beyond_its_data_sheet_says_what_it_may_stand_for(effect: str, factor: float, error: float, beyond: bool) -> None:
    (found,) = calibration_findings([Deviation(number(effect, "piston", "dead_volume_1"), factor, error)])
    assert found.kind == "calibration"  # as the format has it
    assert ("No data sheet leaves so much open" in found.says) is beyond


@pytest.mark.parametrize(("factor", "says"), [(1.2, True), (0.8, False), (1.8, False)])
def test_a_larger_dead_volume_may_be_a_hose_as_warm_as_the_room(factor: float, says: bool) -> None:
    """Its gas is k times as soft as gas that keeps its heat; what no data sheet leaves open is asked elsewhere."""
    (found,) = calibration_findings([Deviation(volume(1), factor, 0.01)])
    assert ("as warm as the room" in found.says) is says


@given(one=FACTORS, other=FACTORS, error=ERRORS)
def test_the_surer_of_the_two_counts_more(one: float, other: float, error: float) -> None:
    (found,) = calibration_findings([Deviation(volume(1), one, error), Deviation(volume(2), other, 3.0 * error)])
    assert found.parameters["factor"].value == pytest.approx(0.9 * one + 0.1 * other)


@given(factor=st.floats(0.5, 2.0), error=ERRORS)
def test_two_that_agree_are_surer_than_one(factor: float, error: float) -> None:
    (alone,) = calibration_findings([Deviation(volume(1), factor, error)])
    (both,) = calibration_findings([Deviation(volume(1), factor, error), Deviation(volume(2), factor, error)])
    for found, spread in ((alone, error), (both, error / 2.0**0.5)):
        interval = found.parameters["factor"]
        assert interval.value == pytest.approx(factor)
        assert (interval.high - interval.low) == pytest.approx(2.0 * 1.959964 * max(spread, GAIN_SHARE), rel=1e-5)
    assert both.log10_odds == pytest.approx(2.0 * alone.log10_odds)


def test_beside_what_was_found_all_that_the_rig_holds_is_written_as_fitted() -> None:
    """Area, dead volumes and zeros were fitted together; where nothing was found a number must be surely off."""
    zero = FreeParameter("sensor_zero", "piston.pressure_1", "pressure_1.bias", "Pa", Target.SENSOR, 500.0, -1e5, 1e5, (0.0, 500.0))
    untouched = number("payload_mass", "slide", "payload_mass")
    values = {number("flow_capacity", "piston", "valve_area"): 1.012, volume(1): 0.992, volume(2): 1.2, zero: 400.0, untouched: 1.0005}
    trial = FittedModel.at(values)
    spread = {q: 0.01 for q in values} | {zero: 0.9 * 400.0 / SURE * 1.2, volume(2): float("inf")}

    def written(named: bool) -> list[str]:
        return [q.parameter for q, _ in refitted_besides(trial, spread, set(), named)]

    assert written(named=True) == ["valve_area", "dead_volume_1", "pressure_1.bias"]
    assert written(named=False) == []
    spread |= {zero: 400.0 / SURE * 0.9, volume(1): 0.008 / SURE * 0.9}
    assert written(named=False) == ["valve_area", "dead_volume_1", "pressure_1.bias"]  # numbers of one fit


@pytest.mark.parametrize(("factor", "error", "off"), [(1.02, 0.003, True), (1.02, 0.03, False), (0.78, 0.12, True), (0.9, 0.12, False)])
def test_a_mass_is_off_where_that_is_sure_or_further_than_a_data_sheet_allows(factor: float, error: float, off: bool) -> None:
    for name in ("payload_mass", "joint_inertia"):
        parameter = FreeParameter(name, "arm", name, "1", Target.SENSOR, 0.02, 0.2, 5.0, (1.0, 0.05), neutral=1.0)
        found = deviations(FittedModel.at({parameter: factor}), {parameter: error})
        assert [one.parameter for one in found] == [parameter] * off


def test_a_number_that_nothing_tells_from_an_effect_says_so() -> None:
    (found,) = calibration_findings([Deviation(number("payload_mass", "slide", "payload_mass"), 0.9, 0.01, twins=("sensor_scale",))])
    assert found.ambiguous_with == ("sensor_scale",)
    assert "sensor scale" in found.says and "10.0 % smaller" in found.says


def test_cylinders_and_kinds_stay_apart() -> None:
    numbers = [
        Deviation(volume(1, "hip"), 1.3, 0.01),
        Deviation(volume(1, "knee"), 0.7, 0.01),
        Deviation(number("flow_capacity", "hip", "valve_area"), 0.9, 0.01),
        Deviation(volume(2, "hip"), 1.2, 0.01),
    ]
    found = {(one.name, one.where): one.parameters for one in calibration_findings(numbers)}
    assert set(found) == {("dead_volume", "hip"), ("dead_volume", "knee"), ("flow_capacity", "hip")}
    assert found["dead_volume", "hip"]["factor"].value == pytest.approx(1.25)
    assert found["dead_volume", "knee"]["factor"].value == 0.7
    assert set(found["dead_volume", "knee"]) == {"factor", "dead_volume_1"}
    assert set(found["flow_capacity", "hip"]) == {"factor"}


def test_nothing_off_is_no_finding() -> None:
    assert calibration_findings([]) == []


def test_a_number_of_an_effect_is_off_only_beyond_what_other_laws_make_of_it() -> None:
    def of_rig(effect: str, name: str, believed: float) -> FreeParameter:
        return FreeParameter(effect, "piston", name, "N", Target.CYLINDER, 1.0, 0.0, 1e5, (believed, 0.5 * believed))

    plain, dip, law = (
        of_rig("coulomb_friction", "force", 10.0), of_rig("stribeck_friction", "breakaway", 20.0),
        FreeParameter("stribeck_friction", "piston", "exponent", "1", Target.CYLINDER, 0.75, 0.5, 2.0, (2.0, 0.75)),
    )  # fmt: skip
    area = number("flow_capacity", "piston", "valve_area")

    def off(share: float) -> list[str]:
        values = {plain: 10.0 * share, dip: 20.0 * share, law: 0.7, area: share}
        found = deviations(FittedModel.at(values), dict.fromkeys(values, 0.01))
        return [one.parameter.parameter for one in found]

    assert off(1.0) == [] and off(0.7) == ["valve_area"]
    assert off(0.6) == off(1.7) == ["force", "valve_area"]
    assert off(0.4) == off(2.5) == ["force", "breakaway", "valve_area"]


def test_a_calibration_is_as_probable_as_was_counted() -> None:
    of_effect = FreeParameter("coulomb_friction", "piston", "force", "N", Target.CYLINDER, 1.0, 0.0, 1e5, (10.0, 5.0))
    numbers = [Deviation(number("flow_capacity", "hip", "valve_area"), 0.5, 1e-3), Deviation(of_effect, 2.0, 0.2)]
    assert {one.name: one.confidence for one in calibration_findings(numbers)} == {
        "flow_capacity": float(CALIBRATED), "coulomb_friction": float(UNTESTED)
    }  # fmt: skip


def test_a_time_is_off_only_beyond_what_clocks_leave_open() -> None:
    delay = FreeParameter("valve_lag", "piston", "delay", "s", Target.CYLINDER, 1e-3, 0.0, 1.0, (9e-3, 2.9e-3))

    def off(value: float) -> bool:
        trial = FittedModel.at({delay: value})
        return bool(deviations(trial, {delay: 1e-4}))

    assert not off(15e-3) and off(40e-3)


def test_an_edge_is_off_only_beyond_what_edges_of_one_spool_differ_by() -> None:
    edge = FreeParameter("valve_edges", "piston", "excess_exhaust_1", "1", Target.CYLINDER, 0.05, -0.95, 4.0, (-0.02, 0.05))

    def off(value: float) -> bool:
        trial = FittedModel.at({edge: value})
        return bool(deviations(trial, {edge: 1e-3}))

    assert not off(-0.06) and not off(0.03) and off(0.4)


def test_a_dead_volume_that_holds_a_hose_which_was_counted_in_is_within_its_data_sheet() -> None:
    dead = volume(1)
    hose = FreeParameter(
        "line_restriction", "piston", "volume", "m^3", Target.CYLINDER, 1e-5, 1e-7, 1e-3, displaces=((dead.key, 1e5),)
    )
    candidate = Candidate("line_restriction", "piston", "volume", (hose,), ((5e-6,),))
    for candidates, beyond in (((candidate,), False), ((), True)):
        model = FittedModel.at({dead: 0.2, **({hose: 8e-6} if candidates else {})}, candidates)
        (found,) = deviations(model, {dead: 0.01, hose: 1e-7})
        assert found.factor == 0.2 and found.is_beyond_data_sheet is beyond
        (finding,) = calibration_findings([found])
        assert ("counted in" in finding.says) is not beyond and ("No data sheet" in finding.says) is beyond


@pytest.mark.parametrize(("with_it", "left"), [(0.97, ()), (1.4, (1.4,))])
def test_a_hose_that_is_not_named_stays_in_the_dead_volume_that_it_was_counted_in(with_it: float, left: tuple[float, ...]) -> None:
    counted = Deviation(volume(1), 0.2, 0.02, counted_in="line_restriction", with_it=with_it)
    own = Deviation(volume(2), 0.6, 0.02)
    gone = {("line_restriction", "piston")}
    assert [one.factor for one in counted_back((counted, own), gone)] == [*left, 0.6]
    assert not any(one.counted_in for one in counted_back((counted,), gone))
    assert counted_back((counted, own), {("line_restriction", "elsewhere")}) == (counted, own)


def test_a_number_is_off_by_the_fit_and_not_within_what_the_form_of_the_laws_leaves_open() -> None:
    area = FreeParameter("flow_capacity", "piston", "valve_area", "1", Target.FACTOR, 0.1, 0.05, 10.0, (1.0, 0.1), neutral=1.0)

    def off(factor: float, by_fit: float, with_form: float) -> bool:
        fitted = FittedModel((), Fit((area,), {area: factor}, np.zeros(4), np.zeros((4, 1))))
        return bool(deviations(fitted, {area: with_form}, {area: by_fit}))

    assert off(1.10, 0.01, 0.04) and not off(1.06, 0.01, 0.04)
    assert not off(1.10, 0.04, 0.04) and off(1.10, 0.01, 0.01)


@pytest.mark.parametrize(("factor", "off"), [(1.0054, False), (1.0066, True), (0.9934, True)])
def test_a_number_is_off_by_more_than_the_gains_of_the_sensors_that_it_was_measured_through(factor: float, off: bool) -> None:
    """Else its interval, which is no narrower than they leave it, would hold what the rig says."""
    mass = number("payload_mass", "slide", "payload_mass")
    model = FittedModel((), Fit((mass,), {mass: factor}, np.zeros(4), np.zeros((4, 1))))
    found = calibration_findings(deviations(model, {mass: 1e-4}))
    assert bool(found) == off
    for one in found:
        assert not one.parameters["factor"].low <= 1.0 <= one.parameters["factor"].high
