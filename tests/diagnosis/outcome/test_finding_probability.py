"""How probable a name is by what it explains of time kept back."""

from __future__ import annotations

from dataclasses import replace

import pytest

from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.outcome.finding_probability import confidence, doubt
from exo_sim.diagnosis.policy.probability import MAY_BE_NIL, UNTESTED
from exo_sim.diagnosis.policy.verdicts import CONFIDENT_BESIDE_UNKNOWN, MOST_CONFIDENT


def named(log10_odds: float, weighed: float | None = None) -> Finding:
    return Finding("quadratic_drag", "piston", Kind.MISSING_PHYSICS, "", {}, log10_odds, 0.0, probability=weighed)


def test_great_odds_do_not_make_a_name_probable_that_explains_little_of_time_kept_back() -> None:
    shares = (0.0, 0.05, 0.14, 0.3, 0.6, 1.0)
    found = [confidence(named(2000.0), share) for share in shares]
    assert found == sorted(found) and found[0] < 0.01 and found[-1] > 0.94
    assert [bool(doubt(named(2000.0), share)) for share in shares] == [True, True, True, False, False, False]


def test_nothing_is_more_probable_than_it_was_weighed() -> None:
    assert confidence(named(300.0, weighed=0.8), 1.0) == 0.8
    assert confidence(named(0.0), 1.0) == 0.5


def test_a_name_of_forces_whose_pressures_nobody_understands_is_not_certain() -> None:
    assert confidence(named(300.0), 1.0, of_doubtful_pressures=True) == CONFIDENT_BESIDE_UNKNOWN < confidence(named(300.0), 1.0)
    assert confidence(named(300.0, weighed=0.6), 1.0, of_doubtful_pressures=True) == 0.6


@pytest.mark.parametrize(("weighed", "said"), [(None, UNTESTED), (0.6, 0.6), (0.99, UNTESTED)])
def test_what_was_not_tested_is_not_certain(weighed: float | None, said: float) -> None:
    assert confidence(named(300.0, weighed), None) == said
    assert said < MOST_CONFIDENT and not doubt(named(300.0, weighed), None)


@pytest.mark.parametrize(("low", "share", "doubted"), [(0.0, None, True), (2.0, None, False), (0.0, 0.9, False)])
def test_a_number_that_may_be_nil_and_that_nothing_tested_is_no_name(low: float, share: float | None, doubted: bool) -> None:
    finding = replace(named(300.0), parameters={"coefficient": Estimate(30.0, "N s^2/m^2", low, 97.0)})
    assert bool(doubt(finding, share)) is doubted


@pytest.mark.parametrize(("low", "weighed", "said"), [(0.0, 1.0, MAY_BE_NIL), (0.0, 0.55, 0.55), (2.0, 0.9, 0.9), (0.0, None, 0.95)])
def test_a_name_whose_number_may_be_nil_is_not_certain(low: float, weighed: float | None, said: float) -> None:
    """Where names were weighed side by side, intervals span all laws; where they were not, numbers of an effect stand in for each other."""
    finding = replace(named(300.0, weighed), parameters={"coefficient": Estimate(50.0, "N s^2/m^2", low, 97.0)})
    assert confidence(finding, 1.0) == pytest.approx(float(said), abs=2e-3)


@pytest.mark.parametrize(
    ("value", "high", "weighed", "doubted"),
    [(30.0, 257.0, 0.999, True), (30.0, 257.0, None, False), (30.0, 84.0, 0.999, False), (-30.0, 40.0, 0.999, True)],
)
def test_a_number_smaller_than_its_error_over_all_laws_is_no_name(
    value: float, high: float, weighed: float | None, doubted: bool
) -> None:
    finding = replace(named(7.0, weighed), parameters={"coefficient": Estimate(value, "N s^2/m^2", min(value, 0.0), high)})
    assert bool(doubt(finding, 0.9)) is doubted


def test_of_several_numbers_one_that_is_not_nil_will_do() -> None:
    parts = {"conductance_1": Estimate(0.3, "W/K", 0.0, 0.6), "conductance_2": Estimate(0.6, "W/K", 0.3, 0.9)}
    assert not doubt(replace(named(300.0), name="wall_heat_transfer", parameters=parts), None)


@pytest.mark.parametrize(("share", "compared", "doubted"), [(None, True, True), (None, False, False), (0.9, True, False)])
def test_a_sensor_at_fault_shows_in_time_kept_back_as_well(share: float | None, compared: bool, doubted: bool) -> None:
    finding = replace(named(300.0), name="sensor_scale", kind=Kind.SENSOR, parameters={"factor": Estimate(1.04, "1", 1.02, 1.06)})
    assert bool(doubt(finding, share, compared)) is doubted


@pytest.mark.parametrize(("backward", "said"), [((18.0, 14.0, 22.0), MAY_BE_NIL), ((24.0, 22.0, 26.0), 0.9)])
def test_friction_of_two_directions_may_be_that_of_one(backward: tuple[float, float, float], said: float) -> None:
    """Both numbers are far from nil: what may be nil is what they tell apart."""
    parts = {"forward": Estimate(16.0, "N", 13.0, 19.0), "backward": Estimate(backward[0], "N", *backward[1:])}
    assert confidence(replace(named(300.0, 0.9), name="asymmetric_friction", parameters=parts), 1.0) == pytest.approx(float(said), abs=2e-3)


def test_how_quickly_a_dip_falls_does_not_say_that_there_is_one() -> None:
    parts = {"breakaway": Estimate(300.0, "N", 0.0, 3e4), "velocity": Estimate(0.02, "m/s", 0.018, 0.022)}
    assert doubt(replace(named(300.0, 0.999), name="stribeck_friction", parameters=parts), 0.9)
