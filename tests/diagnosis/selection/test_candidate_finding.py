"""What is stated of a candidate: its numbers with their intervals, its odds, and the names that explain as much."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.policy import verdicts
from exo_sim.diagnosis.policy.off_nominal import GAIN_SHARE
from exo_sim.diagnosis.selection.candidate_finding import (
    finding_of,
    with_all_parts,
    with_openness_of_law,
    with_twins,
    with_what_it_counts_from,
)
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.search import Search

BASE = waves.BASE.parameters[0]


@pytest.fixture(scope="module")
def search() -> Search:
    return Search(waves.Waves(slow=3.0), (), (waves.BASE,), cheap=True)


@pytest.fixture(scope="module")
def found(search: Search) -> SearchResult:
    return search.run()


@pytest.mark.parametrize(("error", "half"), [(0.5, 0.5), (0.0, None)])
def test_an_interval_is_never_narrower_than_what_models_are_off_by(found: SearchResult, error: float, half: float | None) -> None:
    finding = finding_of(waves.BASE, found.final, {BASE: error}, found)
    ((name, estimate),) = finding.parameters.items()
    wide = HALF_WIDTH * (half if half is not None else GAIN_SHARE * estimate.value)
    assert name == "slow" and estimate.value == found.final.fit.values[BASE]
    assert (estimate.low, estimate.high) == pytest.approx((estimate.value - wide, estimate.value + wide))


@pytest.mark.parametrize(
    ("reach", "says"),
    [
        ((0.5, 40.0), "Other laws explain this recording as well, and set the upper end of the interval of slow."),
        ((30.0, 40.0), "Other laws explain this recording as well, and set the lower and the upper end of the interval of slow."),
        ((0.5, 1.4), ""),
    ],
)
def test_an_end_of_an_interval_that_other_laws_set_is_said_to_be_theirs(
    found: SearchResult, reach: tuple[float, float], says: str
) -> None:
    open_ = replace(found, reach={BASE: reach})
    plain = finding_of(waves.BASE, open_.final, {BASE: 0.5}, open_)
    finding = with_openness_of_law(plain, waves.BASE, open_, {BASE: 0.5})
    assert (says in finding.says) if says else finding is plain


def test_edges_say_which_area_and_which_dead_band_their_numbers_count_from(found: SearchResult) -> None:
    """A fit moves the whole valve's area as well: without that number an excess is the area of no edge."""
    edges, band = (waves.candidate(name, wave) for name, wave in (("valve_edges", "slow"), ("valve_deadband", "quick")))
    area = replace(waves.parameter("flow_capacity", "level"), neutral=1.0)
    plain = Finding("valve_edges", "piston", Kind.MISSING_PHYSICS, "They differ.", {}, 9.0, 0.0)
    beside = replace(found.final, candidates=(edges, band), fit=replace(found.final.fit, values={area: 0.956}))
    says = with_what_it_counts_from(plain, beside).says
    assert "4.4 % smaller than the rig's" in says and "dead band that is named beside it" in says
    alone = replace(found.final, candidates=(edges,), fit=replace(found.final.fit, values={area: 1.0}))
    assert with_what_it_counts_from(plain, alone) is plain
    other = replace(plain, name="valve_offset")
    assert with_what_it_counts_from(other, beside) is other


def test_rivals_weigh_by_what_they_explain_less(found: SearchResult) -> None:
    near, far = waves.candidate("near", "slow"), waves.candidate("far", "slow")
    rivals = {waves.BASE.key: [(near, 1.0), (far, verdicts.AS_GOOD + 0.1), (waves.BASE, 0.0)]}
    finding = finding_of(waves.BASE, found.final, {}, replace(found, rivals=rivals))
    assert finding.ambiguous_with == ("near",)
    assert finding.probabilities == pytest.approx({"base": 1.0 / (1.0 + math.exp(-1.0)), "near": 1.0 / (1.0 + math.e)})


def test_the_interval_covers_what_the_whole_law_says(search: Search, found: SearchResult) -> None:
    law = FreeParameter("leak", "piston", "area", "m^2", Target.SENSOR, 1.0, 0.0, 10.0)
    leak = Candidate("leak", "piston", "area", (law,), ((1.0,),))
    fit = search.fits.fit((waves.BASE,)).fit
    whole = FittedModel((leak,), replace(fit, parameters=(law,), values={law: 2.0}))
    alone = Finding("leak", "piston", Kind.MISSING_PHYSICS, "", {"area": Estimate(3.0, "m^2", 2.9, 3.1)}, 9.0, 0.5)
    assert with_all_parts(alone, leak, found, search.fits) is alone
    both = with_all_parts(alone, leak, replace(found, complete={leak.key: whole}), search.fits).parameters["area"]
    assert (both.value, both.high) == (3.0, 3.1) and 1.5 < both.low < 2.0
    elsewhere = replace(alone, where="other")
    assert with_all_parts(elsewhere, leak, replace(found, complete={leak.key: whole}), search.fits) == elsewhere


def test_twins_are_as_probable_as_the_name_and_are_named_once() -> None:
    finding = Finding("mount", "hip", Kind.MISSING_PHYSICS, "", {}, 9.0, 0.5, ambiguous_with=("play",))
    more = with_twins(finding, ("play", "belt"))
    assert more.ambiguous_with == ("play", "belt")
    assert more.probabilities == pytest.approx(dict.fromkeys(("mount", "play", "belt"), 1.0 / 3.0))
    assert with_twins(finding, ()) is finding


def test_laws_on_the_far_side_of_a_number_do_not_let_its_interval_hold_nil(found: SearchResult) -> None:
    value = found.final.fit.values[BASE]
    wide = replace(found, errors={BASE: 2.0 * value}, reach={BASE: (0.1 * value, 2.0 * value)})
    ends = finding_of(waves.BASE, found.final, {BASE: 2.0 * value}, wide).parameters["slow"]
    assert ends.low == pytest.approx(value - HALF_WIDTH * 0.1 * value) and ends.high > 3.0 * value
    narrow = replace(found, errors={BASE: 0.2 * value}, reach={BASE: (0.1 * value, 0.2 * value)})
    ends = finding_of(waves.BASE, found.final, {BASE: 0.2 * value}, narrow).parameters["slow"]
    assert ends.low == pytest.approx(value - HALF_WIDTH * 0.2 * value)  # holds no nil: as wide as all laws make it


def test_an_interval_holds_a_law_that_lies_further_than_laws_differ(found: SearchResult) -> None:
    value = found.final.fit.values[BASE]
    far = replace(found, errors={BASE: 0.2 * value}, reach={BASE: (0.1 * value, 0.5 * value)})
    ends = finding_of(waves.BASE, found.final, {BASE: 0.2 * value}, far).parameters["slow"]
    assert ends.high == pytest.approx(value * (1.0 + HALF_WIDTH * 0.5)) and ends.low == pytest.approx(value * (1.0 - HALF_WIDTH * 0.2))


@pytest.mark.parametrize(
    ("beside", "down"),
    [(None, 0.85), (("stribeck_friction", "piston"), 1.0), (("stribeck_friction", "slide"), 0.85), (("viscous_friction", "piston"), 0.85)],
    ids=["alone", "a dip there", "a dip elsewhere", "a film"],
)
def test_a_level_of_friction_may_hold_a_dip_that_nothing_showed_apart(beside: tuple[str, str] | None, down: float) -> None:
    """It is known downwards no better than that, unless a dip stands beside it or the rig has one."""
    force = FreeParameter("coulomb_friction", "piston", "force", "N", Target.CYLINDER, 1.0, 0.0, 1e5)
    other = [FreeParameter(*beside, "breakaway", "N", Target.CYLINDER, 1.0, 0.0, 1e5)] if beside else []
    level = Candidate("coulomb_friction", "piston", "force", (force,), ((1.0,),))
    final = FittedModel.at({force: 20.0, **dict.fromkeys(other, 30.0)}, (level,))
    estimate = finding_of(level, final, {force: 1.0}, SearchResult(final, final)).parameters["force"]
    assert (estimate.low, estimate.high) == pytest.approx((down * (20.0 - HALF_WIDTH), 20.0 + HALF_WIDTH))


def test_a_silencer_that_is_no_nozzle_may_be_wider_than_the_nozzle_that_does_as_much() -> None:
    area = FreeParameter("exhaust_back_pressure", "exhaust", "area", "m^2", Target.WORLD, 1e-6, 1e-8, 1e-3)
    silencer = Candidate("exhaust_back_pressure", "exhaust", "area", (area,), ((1e-5,),))
    final = FittedModel.at({area: 1e-5}, (silencer,))
    estimate = finding_of(silencer, final, {area: 1e-7}, SearchResult(final, final)).parameters["area"]
    assert (estimate.low, estimate.high) == pytest.approx((1e-5 - HALF_WIDTH * 1e-7, 1.2 * (1e-5 + HALF_WIDTH * 1e-7)))
