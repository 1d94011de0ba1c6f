"""The rules by which a finding falls on held-out time: refuted, doubtful, too small."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.outcome.held_out_rules import doubt, is_refuted, too_small
from exo_sim.diagnosis.policy.acceptance import RELIEF
from exo_sim.diagnosis.policy.validation import NEGLIGIBLE
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.held_out_gain import HeldOutGain
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult

WIDTH = FreeParameter("valve_deadband", "piston", "width", "1", Target.CYLINDER, 0.0025, 0.0, 0.01, (0.0, 0.0025))


def named(log10_odds: float, weighed: float | None = None) -> Finding:
    return Finding("quadratic_drag", "piston", Kind.MISSING_PHYSICS, "", {}, log10_odds, 0.0, probability=weighed)


def result(model: waves.Waves, *findings: Finding, named: tuple[Candidate, ...] = ()) -> SubsystemResult[waves.Waves]:
    """Return a result with these findings and candidates."""
    final = FittedModel((), Fit((), {}, np.zeros(4), np.zeros((4, 0))))
    found = SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final)
    return replace(found, findings=findings, named=named)


@pytest.mark.parametrize(
    ("drop", "odds", "refuted"),
    [(0.5, 4.0, False), (0.03, 8.0, True), (-0.6, 24.0, True), (-0.6, 60.0, True), (0.02, 160.0, False), (0.14, 60.0, False)],
)
def test_a_finding_stands_where_validation_or_great_odds_support_it(drop: float, odds: float, refuted: bool) -> None:
    assert is_refuted(drop, odds) is refuted


@pytest.mark.parametrize(("drop", "refuted"), [(0.11, False), (0.03, False), (0.01, True), (-0.05, True)])
def test_less_is_asked_of_what_was_weighed_beside_all_others(drop: float, refuted: bool) -> None:
    assert is_refuted(drop, 8.0, together=True) is refuted


@pytest.mark.parametrize(
    ("drop", "share", "refuted"), [(0.14, 0.9, False), (0.1, 0.2, False), (0.05, 0.1, True), (0.0, 0.0, True), (0.14, None, True)]
)
def test_where_something_is_missing_without_a_finding_its_share_of_that_counts(drop: float, share: float | None, refuted: bool) -> None:
    gain = None if share is None else HeldOutGain(100.0 * share, 100.0)
    assert is_refuted(drop, 8.0, gain) is refuted
    assert is_refuted(drop, 60.0, gain) is False  # great odds
    assert is_refuted(0.05, 8.0, gain, together=True) is False


def test_an_error_that_rises_by_chance_refutes_no_name_of_great_odds() -> None:
    absent, undecided = HeldOutGain(-20.0, 100.0, True, 0.02, 0.1), HeldOutGain(-20.0, 100.0, True, 0.5, 0.67)
    assert is_refuted(-0.18, 26.0, absent)
    assert not is_refuted(-0.18, 26.0, undecided)
    assert is_refuted(-0.18, 13.0, undecided)  # useless there, and its odds are not great


@pytest.mark.parametrize(
    ("odds", "more", "refuted"),
    [
        (11.6, -1.4, False),  # its change is hardly there, and it is certain all the same
        (6.3, -1.3, True),
        (60.6, -7.1, False),
        (2.4, 0.0, True),  # that time tells nothing of its change: then the error does
        (2.4, 1.1, False),  # it speaks for it
        (0.8, -0.4, True),
    ],
)
@pytest.mark.parametrize(("plain", "together"), [(False, False), (False, True), (True, True)])
def test_an_error_of_forces_or_of_noise_refutes_only_what_is_not_certain(
    odds: float, more: float, refuted: bool, plain: bool, together: bool
) -> None:
    gain = HeldOutGain(-20.0, 100.0, plain, 0.02, 0.1, more)
    assert is_refuted(-0.5, odds, gain, together) is refuted


def test_what_is_surely_there_is_not_useless_however_much_else_is_missing() -> None:
    assert not is_refuted(0.01, 20.0, HeldOutGain(3.0, 100.0, True, 0.95, 0.05))
    assert is_refuted(0.01, 20.0, HeldOutGain(3.0, 100.0, True, 0.95, 0.6))


@pytest.mark.parametrize("share", [0.0, 0.05, 0.14])
def test_great_odds_do_not_save_a_name_that_explains_little_of_time_kept_back(share: float) -> None:
    assert f"explains {100 * share:.0f} %" in doubt(named(2000.0), share)


@pytest.mark.parametrize("share", [0.3, 0.6, 1.0])
def test_a_name_that_explains_more_of_it_is_not_in_doubt(share: float) -> None:
    assert doubt(named(2000.0), share) == ""


@pytest.mark.parametrize("weighed", [None, 0.6, 0.99])
def test_a_name_without_numbers_that_nothing_tested_is_not_in_doubt(weighed: float | None) -> None:
    assert doubt(named(300.0, weighed), None) == ""


@pytest.mark.parametrize(("low", "share", "doubted"), [(0.0, None, True), (2.0, None, False), (0.0, 0.9, False)])
def test_a_number_that_may_be_nil_and_that_nothing_tested_is_no_name(low: float, share: float | None, doubted: bool) -> None:
    finding = replace(named(300.0), parameters={"coefficient": Estimate(30.0, "N s^2/m^2", low, 97.0)})
    assert bool(doubt(finding, share)) is doubted


@pytest.mark.parametrize(("odds", "doubted"), [(114.0, False), (0.4, True)])
def test_a_lag_that_cannot_be_left_out_is_no_name_for_want_of_odds_and_not_for_a_vague_share(odds: float, doubted: bool) -> None:
    lag = replace(named(odds), name="valve_lag", parameters={"time_constant": Estimate(4.7e-3, "s", 0.0, 9e-3)})
    assert bool(doubt(lag, None, compared=False)) is doubted


def test_beside_an_unknown_a_name_stands_only_with_a_number_that_is_not_nil() -> None:
    finding = replace(named(300.0), parameters={"coefficient": Estimate(30.0, "N s^2/m^2", 0.0, 97.0)})
    assert not doubt(finding, 0.9) and "without a name" in doubt(finding, 0.9, beside_unknown=True)
    sure = replace(finding, parameters={"coefficient": Estimate(30.0, "N s^2/m^2", 2.0, 97.0)})
    assert not doubt(sure, 0.9, beside_unknown=True)


@pytest.mark.parametrize(
    ("value", "high", "weighed", "doubted"),
    [(30.0, 257.0, 0.999, True), (30.0, 257.0, None, False), (30.0, 84.0, 0.999, False), (-30.0, 40.0, 0.999, True)],
)
def test_a_number_smaller_than_its_error_over_all_laws_is_no_name(
    value: float, high: float, weighed: float | None, doubted: bool
) -> None:
    finding = replace(named(7.0, weighed), parameters={"coefficient": Estimate(value, "N s^2/m^2", min(value, 0.0), high)})
    assert bool(doubt(finding, 0.7)) is doubted
    assert not doubt(finding, 0.95)  # held-out time bears it out


def test_of_several_numbers_one_that_is_not_nil_will_do() -> None:
    parts = {"conductance_1": Estimate(0.3, "W/K", 0.0, 0.6), "conductance_2": Estimate(0.6, "W/K", 0.3, 0.9)}
    assert not doubt(replace(named(300.0), name="wall_heat_transfer", parameters=parts), None)


@pytest.mark.parametrize(("share", "compared", "doubted"), [(None, True, True), (None, False, False), (0.9, True, False)])
def test_a_sensor_at_fault_shows_in_time_kept_back_as_well(share: float | None, compared: bool, doubted: bool) -> None:
    finding = replace(named(300.0), name="sensor_scale", kind=Kind.SENSOR, parameters={"factor": Estimate(1.04, "1", 1.02, 1.06)})
    assert bool(doubt(finding, share, compared)) is doubted


@pytest.mark.parametrize(("odds", "doubted"), [(7.0, True), (95.0, False)])
def test_how_quickly_a_dip_falls_does_not_say_that_there_is_one_but_great_odds_against_all_laws_without_it_do(
    odds: float, doubted: bool
) -> None:
    parts = {"breakaway": Estimate(300.0, "N", 0.0, 3e4), "velocity": Estimate(0.02, "m/s", 0.018, 0.022)}
    assert bool(doubt(replace(named(odds, 0.999), name="stribeck_friction", parameters=parts), 0.7)) is doubted


@pytest.mark.parametrize(
    ("left", "tested", "is_small"), [(1.1, False, True), (3.0, False, False), (1.1, True, False)], ids=["little", "plain", "tested"]
)
def test_a_finding_without_which_the_machine_is_missed_no_more_than_a_healthy_one_is_small(
    left: float, tested: bool, is_small: bool
) -> None:
    leak = Finding("piston_leakage", "piston", Kind.MISSING_PHYSICS, "", {}, 80.0, 0.0)
    one = result(waves.Waves(bound=1.2), leak)
    key = "piston_leakage@piston"
    found = too_small(one, {key: left}, {}, {}, {key: HeldOutGain(50.0, 100.0)} if tested else {})
    assert [finding.name for finding in found] == (["piston_leakage"] if is_small else [])
    assert not found or "beyond doubt" in found[0].says


@pytest.mark.parametrize(
    ("odds", "more", "is_small"), [(1.6, 0.3, True), (-0.9, 0.6, True), (32.9, -0.7, False), (9.0, -4.0, True), (3.0, 5.0, False)]
)
def test_what_explains_a_little_of_what_healthy_machines_leave_is_small_unless_it_is_certain(
    odds: float, more: float, is_small: bool
) -> None:
    back = Finding("exhaust_back_pressure", "exhaust", Kind.MISSING_PHYSICS, "", {}, odds, 0.0)
    one, tested = result(waves.Waves(bound=3.8), back), {back.key: HeldOutGain(24.0, 100.0, log10_odds=more)}
    found = too_small(one, {back.key: 3.7}, {}, {}, tested)
    assert bool(found) is is_small
    assert all("do not show it surely" in each.says and "beyond doubt" not in each.says for each in found)
    assert too_small(one, {back.key: 3.9}, {}, {}, tested) == ()  # no healthy machine leaves so much
    weighed = replace(one, search=replace(one.search, weighed_together=True))
    assert too_small(weighed, {back.key: 3.7}, {}, {}, tested) == ()


def test_what_returns_the_numbers_of_a_rig_to_their_data_sheets_is_not_small() -> None:
    ratio = Finding("critical_ratio", "piston", Kind.MISSING_PHYSICS, "", {}, 40.0, 0.0)
    one = result(waves.Waves(bound=1.2), ratio)
    assert too_small(one, {ratio.key: 1.0}, {}, {}, {}, {ratio.key: RELIEF - 1.0}) != ()
    assert too_small(one, {ratio.key: 1.0}, {}, {}, {}, {ratio.key: RELIEF + 1.0}) == ()
    unsure = result(waves.Waves(bound=1.2), replace(ratio, log10_odds=2.0))
    assert too_small(unsure, {ratio.key: 1.0}, {}, {}, {}, {ratio.key: RELIEF + 1.0}) != ()


def test_what_another_finding_needs_is_not_small() -> None:
    heat = Finding("wall_heat_transfer", "piston", Kind.MISSING_PHYSICS, "", {}, 80.0, 0.0)
    wall = Candidate("moving_wall_temperature", "piston", "form", (WIDTH,), ((1.0,),), prerequisite="wall_heat_transfer")
    one = result(waves.Waves(bound=1.2), heat, named=(wall,))
    key = "wall_heat_transfer@piston"
    assert too_small(one, {key: 1.1}, {}, {}, {}) == () and too_small(replace(one, named=()), {key: 1.1}, {}, {}, {}) != ()


@pytest.mark.parametrize(
    ("missed", "changed", "is_small"),
    [(0.7, 0.5, True), (1.6, 0.5, False), (1.6, 0.01, True), (0.7, 4.0, False), (None, None, False)],
    ids=["as noise does", "by more", "by more, for something else", "more than any healthy machine", "not tested"],
)
def test_a_name_of_forces_is_small_where_noise_and_healthy_laws_explain_the_rows_that_it_changes(
    missed: float | None, changed: float | None, is_small: bool
) -> None:
    spring = Finding("return_spring", "piston", Kind.MISSING_PHYSICS, "", {}, 80.0, 0.0)
    one = result(waves.Waves(bound=1.2), spring)
    weighed = replace(one, search=replace(one.search, weighed_together=True))
    acting = {} if missed is None else {spring.key: missed}, {} if changed is None else {spring.key: changed}
    assert bool(too_small(weighed, {spring.key: 1.1}, *acting, {})) is is_small
    missing = {spring.key: HeldOutGain(50.0, 100.0)}  # as a whole more than noise
    assert bool(too_small(weighed, {spring.key: 1.1}, *acting, missing)) is (changed is not None and changed < NEGLIGIBLE)
    assert too_small(one, {spring.key: 1.1}, *acting, {}) != ()  # of gas all its rows count
