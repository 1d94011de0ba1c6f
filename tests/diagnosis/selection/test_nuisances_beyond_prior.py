"""Numbers that a fit moved further than any data sheet allows give way to the physics that they stand for, where that explains as much."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy.acceptance import SURELY_MORE
from exo_sim.diagnosis.policy.off_nominal import HELD_WITHIN
from exo_sim.diagnosis.policy.verdicts import AS_GOOD
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nuisances_beyond_prior import _held, absorbers, is_beyond_data_sheet, relieved, strained
from exo_sim.diagnosis.selection.proposals import Proposals
from exo_sim.diagnosis.selection.quantity_parts import healthy_limits

#: One standard deviation of what data sheets leave open of the number.
OPEN = 1.0
VOLUME = waves.parameter("dead_volume", "slow", prior=(0.0, OPEN))
HOSE = waves.candidate("line_restriction", "hose")
#: Some of what a hose does is that of a larger volume.
SHAPES = {**waves.SHAPES, "hose": waves.SHAPES["slow"] + 0.1 * waves.SHAPES["quick"], "same": waves.SHAPES["slow"]}
KEPT = Split({}, {"recording": ((0.0, 1.0),)})


class Volume(waves.Waves):
    """Waves of which the slow one is taken by a dead volume if nothing else does; less than a hundredth of the noise does not matter."""

    @property
    def practical_significance(self) -> float:
        return 0.01


class Misleading(Volume):
    """Held-out time that shows nothing of what a hose would do."""

    def on_test_time(self, split: Split) -> Volume:
        return Volume(shapes=self.shapes, slow=6.0, quick=-0.6)


def ended(model: Volume, *candidates: Candidate, volume: FreeParameter = VOLUME) -> tuple[SearchResult, ModelFits, Proposals]:
    """Return a search that found nothing, as where what is left beside a strained number is too little to ask."""
    fits = ModelFits(model, (volume,))
    alone = fits.refined(fits.fit((), FittedModel.at({volume: 6.0})))
    return SearchResult(alone, alone), fits, Proposals(fits, candidates, 0.0)


@pytest.mark.parametrize(
    ("value", "error", "beyond"), [(3.4, 0.0, False), (3.6, 0.0, True), (3.6, 0.1, False), (6.0, 0.5, True), (-6.0, 0.5, True)]
)
def test_a_number_is_beyond_its_data_sheet_where_no_error_explains_it(value: float, error: float, beyond: bool) -> None:
    assert is_beyond_data_sheet(VOLUME, value, error) is beyond


def test_a_number_at_the_end_of_what_it_may_be_is_beyond_however_narrow_that_is() -> None:
    narrow = replace(VOLUME, low=0.0, high=OPEN)
    assert is_beyond_data_sheet(narrow, OPEN, 3.0)
    assert not is_beyond_data_sheet(narrow, 0.0, 3.0)  # there it is what is believed


def test_what_an_effect_of_the_model_says_itself_is_not_strained() -> None:
    own = waves.candidate("valve_lag", "slow")
    lag = waves.parameter("valve_lag", "slow", prior=(0.0, OPEN))
    search, fits, _ = ended(Volume(shapes=SHAPES, slow=6.0), volume=lag)
    assert strained(search.final, fits) == (lag,)
    assert strained(fits.fit((own,), search.final), fits) == ()


def test_a_hose_takes_back_what_the_dead_volume_took() -> None:
    model = Volume(shapes=SHAPES, hose=6.0)
    search, fits, proposals = ended(model, waves.BASE, HOSE)
    assert search.final.fit.values[VOLUME] > 5.0
    found, bounded = relieved(search, fits, proposals, model, KEPT)
    assert {c.effect for c in found.final.candidates} == {"line_restriction"}
    assert found.final.fit.values[HOSE.parameters[0]] == pytest.approx(6.0, abs=0.5)
    assert all(abs(v) < HELD_WITHIN * OPEN for q, v in found.final.fit.values.items() if q.effect == "dead_volume")
    (finding,) = decide("piston", model, bounded, found).findings
    assert finding.name == "line_restriction" and finding.log10_odds > 100.0


def test_where_the_number_alone_explains_as_much_the_finding_says_so() -> None:
    model = Volume(shapes=SHAPES, slow=6.0)
    search, fits, proposals = ended(model, waves.candidate("line_restriction", "same"))
    found, bounded = relieved(search, fits, proposals, model, KEPT)
    (finding,) = decide("piston", model, bounded, found).findings
    assert finding.name == "line_restriction" and finding.ambiguous_with == ("dead_volume",)
    assert finding.probabilities["line_restriction"] > finding.probabilities["dead_volume"] > 0.1


def test_where_the_number_is_more_probable_it_stays_the_finding_and_says_what_it_may_stand_for() -> None:
    model = Volume(shapes=SHAPES, slow=6.0)
    same = waves.candidate("line_restriction", "same")
    search, fits, proposals = ended(model, replace(same, prevalence=0.02))
    found, bounded = relieved(search, fits, proposals, model, KEPT)
    assert found.final is search.final and bounded is fits
    assert found.stands_for == {("dead_volume", "piston"): ("line_restriction",)}


def test_a_hose_that_a_search_found_itself_is_held_against_the_number_as_well() -> None:
    same = waves.candidate("line_restriction", "same")
    same = replace(same, parameters=(replace(same.parameters[0], displaces=((VOLUME.key, 1.0),)),))
    model = Volume(shapes=SHAPES, slow=6.0)
    _, fits, proposals = ended(model, same)
    named = fits.refined(fits.fit((same,)))
    found, _ = relieved(SearchResult(fits.fit(()), named), fits, proposals, model, KEPT)
    assert found.final is named
    ((rival, worse),) = found.rivals[same.key]
    assert rival.effect == "dead_volume" and worse < AS_GOOD


@pytest.mark.parametrize(
    ("model", "candidate"),
    [
        (Volume(shapes=SHAPES, slow=6.0), waves.candidate("line_restriction", "quicker")),  # explains something else
        (Volume(shapes=SHAPES, slow=6.0), waves.candidate("piston_leakage", "same")),  # not declared to be like it
        (Volume(shapes=SHAPES, slow=0.5), waves.candidate("line_restriction", "same")),  # within its data sheet
        (Misleading(shapes=SHAPES, hose=6.0), HOSE),  # held-out time says no
    ],
)
def test_without_an_effect_that_explains_as_much_everything_stays_as_it_is(model: Volume, candidate: Candidate) -> None:
    search, fits, proposals = ended(model, candidate)
    assert relieved(search, fits, proposals, model, KEPT) == (search, fits)


def test_a_hose_that_rings_is_begun_beside_numbers_that_are_held_at_the_shape_that_leaves_least() -> None:
    model = waves.Ringing(6.0, 20.4)
    fits = ModelFits(model, (VOLUME,))
    alone, proposals = fits.refined(fits.fit((), FittedModel.at({VOLUME: 6.0}))), Proposals(fits, (waves.RINGS,), 0.0)
    found, _ = relieved(SearchResult(alone, alone), fits, proposals, model, KEPT)
    assert found.final.fit.values[waves.RATE] == pytest.approx(20.4, abs=0.1)
    assert found.final.fit.values[waves.SIZE] == pytest.approx(6.0, abs=0.5)


@pytest.mark.parametrize("form", ["any form", "valve_lag.slow"], ids=["of another form", "of these very numbers"])
def test_more_than_healthy_parts_show_is_asked_as_the_effect_itself(form: str) -> None:
    lag = replace(waves.parameter("valve_lag", "slow", prior=(0.0, 1.0)), low=0.0, high=3.0)
    own = replace(waves.candidate("valve_lag", "slow"), form=form)
    model = Volume(shapes=SHAPES, slow=3.4)
    search, fits, proposals = ended(model, own, waves.BASE, volume=lag)
    assert search.final.fit.values[lag] == pytest.approx(3.0)
    found, _ = relieved(search, fits, proposals, model, KEPT)
    assert found.final.fit.values[own.parameters[0]] == pytest.approx(3.4, abs=0.2)
    (named,) = found.final.candidates
    assert named.effect == "valve_lag" and named.kind is Kind.MISSING_PHYSICS


@pytest.mark.parametrize(("limit", "named"), [(3.0, True), (5.0, False)])
def test_a_law_is_asked_where_healthy_machines_do_not_follow_it_so_far_though_what_it_comes_on_top_of_is_not_there(
    limit: float, named: bool
) -> None:
    """Edges of a valve that differ by half as much again as those of any other: all that was free of them ended at its bounds."""
    edge = replace(waves.parameter("valve_edges", "slow", prior=(0.0, 1.0)), low=-3.0, high=3.0)
    law = replace(waves.candidate("valve_edges", "slow", prerequisite="valve_deadband"), is_law=True)
    law = replace(law, parameters=tuple(replace(q, healthy_limit=limit) for q in law.parameters))
    model = Volume(shapes=SHAPES, slow=4.5)
    search, fits, proposals = ended(model, law, volume=edge)
    found, _ = relieved(search, fits, proposals, model, KEPT)
    assert [c.effect for c in found.final.candidates] == (["valve_edges"] if named else [])
    if named:
        assert found.final.fit.values[law.parameters[0]] == pytest.approx(4.5, abs=0.2)


class Cards(Volume):
    """Pressures that are late show as a position that is early."""

    def residual_of(self, plant: PlantParameters) -> np.ndarray:
        early = {"position.delay": -1.0}
        return super().residual_of(replace(plant, sensors={name: early.get(name, 1.0) * v for name, v in plant.sensors.items()}))


@pytest.mark.parametrize(("late", "named"), [(3.1, True), (2.0, False)])
def test_a_card_that_is_later_than_any_healthy_one_is_a_finding_though_a_position_could_be_as_early(late: float, named: bool) -> None:
    """Only the difference shows: it is known far better than what is priors' of either."""
    clock = replace(waves.parameter("card_delay", "delay", prior=(0.0, 1.0)), parameter="position.delay", low=-2.5, high=2.5)
    card = replace(waves.candidate("sensor_delay", "delay"), kind=Kind.SENSOR)
    seconds = replace(card.parameters[0], parameter="pressures.delay", healthy_limit=2.5)
    card = replace(card, parameters=(seconds,))
    model = Cards(shapes={**SHAPES, "delay": 5.0 * waves.SHAPES["slow"]}, delay=late)
    fits = ModelFits(model, (clock,))
    alone = fits.refined(fits.fit((), FittedModel.at({clock: -2.0})))
    found, own = relieved(SearchResult(alone, alone), fits, Proposals(fits, (card,), 0.0), model, KEPT)
    assert [c.effect for c in found.final.candidates] == (["sensor_delay"] if named else [])
    if named:
        assert found.final.fit.values[seconds] == pytest.approx(late, abs=0.1)
        assert own.standard_errors(found.final)[seconds] < 0.1 < 0.5 < own.standard_errors(found.final)[own.nuisances[0]]


def test_who_is_asked_is_declared_with_the_effects() -> None:
    search, _, _ = ended(Volume(shapes=SHAPES, slow=6.0))
    there = [waves.candidate(name, "quick") for name in ("line_restriction", "valve_lag", "heat_transfer_law", "piston_leakage")]
    law = replace(there[2], is_law=True)
    assert [c.effect for c in absorbers((VOLUME,), search.final, (there[0], there[1], law, there[3]))] == ["line_restriction"]



#: Waiting and following are late alike, but for a little: their sum is known ten times better than either.
LATE = {**waves.SHAPES, "delay": waves.SHAPES["slow"], "time_constant": waves.SHAPES["slow"] + 0.1 * waves.SHAPES["quick"]}


def _late(
    delay: float, time_constant: float
) -> tuple[Volume, SearchResult, ModelFits, Proposals, tuple[FreeParameter, FreeParameter], Candidate]:
    """Return a search of a valve that is late by so much, of which up to 3 is healthy however it is shared."""
    parts = [replace(waves.parameter("valve_lag", name, prior=(0.0, 2.0)), low=0.0, high=3.0) for name in ("delay", "time_constant")]
    lag = replace(waves.candidate("valve_lag", "delay", "time_constant"), additive=True)
    lag = replace(lag, parameters=tuple(replace(q, healthy_limit=3.0, low=0.0) for q in lag.parameters))
    model = Volume(shapes=LATE, delay=delay, time_constant=time_constant)
    fits = ModelFits(model, parts)
    proposals = Proposals(fits, (lag,), 0.0)
    alone = fits.refined(fits.fit((), FittedModel.at(dict.fromkeys(parts, 1.5))))
    return model, SearchResult(alone, alone), fits, proposals, (parts[0], parts[1]), lag


def test_parts_are_judged_by_how_well_their_sum_is_known() -> None:
    model, search, fits, proposals, parts, lag = _late(1.9, 1.9)
    errors = fits.standard_errors(search.final)
    assert sum(search.final.fit.values[q] - SURELY_MORE * errors[q] for q in parts) < 3.0  # neither alone is known
    assert strained(search.final, fits, healthy_limits((lag,))) == parts
    found, _ = relieved(search, fits, proposals, model, KEPT)
    assert [c.effect for c in found.final.candidates] == ["valve_lag"]
    assert strained(search.final, fits) == ()


def test_what_is_healthy_however_it_is_shared_is_not_asked_as_an_effect() -> None:
    """Late by 3.0, all of it waiting: a fit that has shared it out otherwise is held within that as well."""
    _, search, fits, _, parts, _ = _late(3.0, 0.05)
    pressed = replace(search.final, fit=replace(search.final.fit, values={**search.final.fit.values, parts[0]: 0.3, parts[1]: 2.9}))
    _, bounded, _, held = _held(parts, pressed, fits, {("valve_lag", "piston", "1"): 3.0})
    assert sum(held.fit.values.values()) <= 3.0 + 1e-9
    assert bounded.deficit(held, search.final) < 1.0


@pytest.mark.parametrize(("quick", "form"), [(2.0, "slow+quick"), (0.0, "slow")], ids=["goes on", "ends there"])
def test_what_numbers_gave_way_to_is_asked_how_its_law_goes_on(quick: float, form: str) -> None:
    """Machine m09 of the thirteenth stranger: of a slow spool, free as a healthy one's lag, the search could not ask for its inertia."""
    lag = replace(waves.parameter("valve_lag", "slow", prior=(0.0, 1.0)), low=0.0, high=3.0)
    own = waves.candidate("valve_lag", "slow")
    richer = replace(waves.candidate("valve_lag", "slow", "quick"), further=frozenset({"valve_lag.quick"}))
    model = Volume(shapes=SHAPES, slow=4.5, quick=quick)
    search, fits, proposals = ended(model, own, richer, volume=lag)
    found, _ = relieved(search, fits, proposals, model, KEPT)
    (named,) = found.final.candidates
    assert named.form == form and set(found.evidence) == {named.key}
    assert found.final.fit.values[named.parameters[-1]] == pytest.approx(quick or 4.5, abs=0.2)
