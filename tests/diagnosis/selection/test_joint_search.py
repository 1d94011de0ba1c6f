"""The search from the other end: what is there together is found together, and nothing where something has no name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from diagnosis.waves import BASE, OTHER, RATE, RINGS, Ringing, Waves, candidate

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.selection import joint_search
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.joint_search import JointSearch
from exo_sim.diagnosis.selection.search import Search
from exo_sim.diagnosis.selection.simplification import Simplification

ASKED = (BASE, OTHER, candidate("level", "level"))


def begun(
    model: Waves, is_spent: Callable[[], bool] = lambda: False, asked: tuple[Candidate, ...] = ASKED,
    goes_elsewhere: Callable[[FittedModel], bool] = lambda _: False,
) -> tuple[JointSearch, FittedModel]:
    """Return a search, for two waves and a level where nothing else is said, and its baseline."""
    one = Search(model, (), asked)
    bare = one.fits.refined(one.fits.fit(()))
    comparisons = Comparisons(one.fits, bare, 3, 0.0)
    simplification = Simplification(one.fits, comparisons, one.proposals)
    return JointSearch(one.fits, comparisons, one.proposals, simplification, lambda words: None, is_spent, goes_elsewhere), bare


def test_what_is_there_together_is_found_together() -> None:
    search, bare = begun(Waves(slow=8.0, quicker=6.0))
    found = search.found_together(bare)
    assert found.explains and {c.effect for c in found.model.candidates} == {"base", "other"}
    sizes = {c.effect: found.model.fit.values[c.parameters[0]] for c in found.model.candidates}
    assert sizes == pytest.approx({"base": 8.0, "other": 6.0}, abs=0.3)


@pytest.mark.parametrize(("level", "healthy", "named"), [(9.0, 0.0, True), (0.8, 0.0, False), (9.0, 20.0, False)])
def test_a_sensor_that_misleads_is_found_before_another_subsystem_is_asked(level: float, healthy: float, named: bool) -> None:
    """Faults of sensors are not proposed with effects; one that explains the larger part of what those leave is seen beside them."""
    late = candidate("sensor_delay", "level")
    late = replace(late, kind=Kind.SENSOR, parameters=(replace(late.parameters[0], healthy_limit=healthy),))
    search, bare = begun(Waves(slow=8.0, quicker=6.0, level=level), asked=(BASE, OTHER, late), goes_elsewhere=lambda _: True)
    found = search.found_together(bare).model
    assert BASE in found.candidates and any(c.kind is Kind.SENSOR for c in found.candidates) is named


def test_where_more_is_left_than_a_healthy_machine_leaves_it_explains_nothing_though_there_is_a_model() -> None:
    search, bare = begun(Waves(1.5, slow=8.0, quick=6.0))
    found = search.found_together(bare)
    assert not found.explains and "base" in {c.effect for c in found.model.candidates}


def test_proposals_are_made_beside_nothing_as_well_where_those_beside_a_model_leave_more_than_a_healthy_machine(
    monkeypatch: pytest.MonkeyPatch
) -> None:
    search, bare = begun(Waves(1.5, slow=8.0, quick=6.0))
    beside: list[int] = []
    paths: list[set[tuple[str, str]]] = []
    a_round, reached = JointSearch._after_a_round, JointSearch._reached_from

    def counted(self: JointSearch, now: FittedModel) -> FittedModel:
        beside.append(len(now.candidates))
        return a_round(self, now)

    def followed(self: JointSearch, begun: FittedModel, goes_on: bool) -> FittedModel:
        paths.append(begun.named)
        return reached(self, begun, goes_on)

    monkeypatch.setattr(JointSearch, "_after_a_round", counted)
    monkeypatch.setattr(JointSearch, "_reached_from", followed)
    for chosen, rounds in (((), [0]), ((BASE,), [1, 0]), ((OTHER,), [1, 0])):  # the second wave is not there: it goes
        del beside[:], paths[:]
        search.found_together(search.fits.fit(chosen, bare))
        assert beside[: len(rounds)] == rounds and len(paths) == len({frozenset(one) for one in paths})  # no way is gone twice
    enough = begun(Waves(20.0, slow=8.0, quick=6.0))[0]
    beside.clear()
    enough.found_together(enough.fits.fit((BASE,), enough.comparisons.baseline))
    assert 0 not in beside


def test_of_two_ways_that_which_leads_further_at_once_is_followed_first(monkeypatch: pytest.MonkeyPatch) -> None:
    search, bare = begun(Waves(1.2, slow=8.0, quicker=6.0))
    misled = search.fits.fit((candidate("third", "level"),), bare)
    first: list[set[str]] = []
    a_round, reached = JointSearch._after_a_round, JointSearch._reached_from

    def followed(self: JointSearch, begun: FittedModel, goes_on: bool) -> FittedModel:
        first.append({c.effect for c in begun.candidates})
        return reached(self, begun, goes_on)

    monkeypatch.setattr(JointSearch, "_after_a_round", lambda self, now: now if now is misled else a_round(self, now))
    monkeypatch.setattr(JointSearch, "_reached_from", followed)
    assert search.found_together(misled).explains and first[0] == {"base", "other"}


def test_what_another_subsystem_is_to_be_asked_for_first_is_handed_on_as_it_was_proposed(monkeypatch: pytest.MonkeyPatch) -> None:
    search, bare = begun(Waves(1.5, slow=8.0, quick=6.0))
    monkeypatch.setattr(search, "_goes_elsewhere", lambda model: any(c.effect == "base" for c in model.candidates))
    monkeypatch.setattr(search, "extended", lambda model: pytest.fail("nothing more is sought beside it"))
    found = search.found_together(bare)
    assert not found.explains and "base" in {c.effect for c in found.model.candidates}


def test_nothing_is_asked_when_the_time_is_up() -> None:
    search, bare = begun(Waves(slow=8.0, quicker=6.0), lambda: True)
    found = search.found_together(bare)
    assert not found.explains and found.model.candidates == ()


def test_what_a_closed_form_leaves_out_stays_where_a_fit_misses_it(monkeypatch: pytest.MonkeyPatch) -> None:
    search, bare = begun(Waves(slow=8.0, quicker=6.0))
    both = search.fits.refined(search.fits.fit((BASE, OTHER), bare))
    monkeypatch.setattr(joint_search, "jointly_pruned", lambda model, now, threads: now.candidates[:1])
    assert search._jointly_pruned(both) is both


def test_what_rings_is_begun_at_its_best_shape_whatever_a_fit_from_elsewhere_found_before() -> None:
    search, bare = begun(Ringing(8.0, 20.4, quicker=6.0), asked=(OTHER, RINGS))
    now = search.fits.refined(search.fits.fit((OTHER,), bare))
    before = search.fits.fit((OTHER, RINGS), now)
    assert abs(before.fit.values[RATE] - 20.4) > 1.0
    assert search.extended(now).fit.values[RATE] == pytest.approx(20.4, abs=0.1)


@pytest.mark.parametrize(("rate", "begun_anew"), [(20.4, True), (6.0, False)])
def test_what_came_with_others_in_another_optimum_is_begun_anew_at_its_best_shape(rate: float, begun_anew: bool) -> None:
    search, bare = begun(Ringing(8.0, rate, quicker=6.0), asked=(OTHER, RINGS))
    before = search.fits.refined(search.fits.fit((OTHER, RINGS), bare))
    after = search._reshaped(before)
    assert (after is not before) is begun_anew
    assert after.fit.values[RATE] == pytest.approx(rate, abs=0.1)


def test_what_keeps_the_others_from_going_on_at_its_shape_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    search, bare = begun(Ringing(8.0, 20.4, quicker=6.0), asked=(OTHER, RINGS))
    without = search.fits.refined(search.fits.fit((OTHER,), bare))
    stuck = replace(search.fits.fit((OTHER, RINGS), bare), fit=replace(without.fit, residual=1.1 * without.fit.residual))
    monkeypatch.setattr(search.proposals, "reshaped", lambda *_: pytest.fail("it is not begun anew"))
    assert search._reshaped(stuck).candidates == (OTHER,)
