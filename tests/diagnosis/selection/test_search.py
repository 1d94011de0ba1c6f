"""The search: what comes on top of another effect waits for it; models grow, are pruned, and stop where they should."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from diagnosis.waves import AT, BASE, ON_TOP, OTHER, SHAPES, Waves, candidate

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.estimation.threads import Threads
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.joint_search import JointSearch, Together
from exo_sim.diagnosis.selection.proposals import Proposals
from exo_sim.diagnosis.selection.search import Search, StoppingCriteria, WarmStart


def model(*chosen: Candidate) -> FittedModel:
    return FittedModel.at({}, chosen)


def search(waves: Waves, cheap: bool, candidates: tuple[Candidate, ...] = (BASE, ON_TOP, OTHER)) -> Search:
    return Search(waves, (), candidates, cheap=cheap)


def test_only_what_stands_on_its_own_or_on_what_is_there_is_borne() -> None:
    assert model().meets_prerequisite(BASE) and model().meets_prerequisite(OTHER)
    assert not model().meets_prerequisite(ON_TOP)
    assert not model(OTHER).meets_prerequisite(ON_TOP)
    assert model(BASE).meets_prerequisite(ON_TOP) and model(OTHER, BASE).meets_prerequisite(ON_TOP)


def test_a_screen_leaves_out_what_is_not_borne() -> None:
    one = search(Waves(quick=5.0), cheap=False)
    assert {found.effect for _, found in one.proposals.scored(one.fits.fit(()))} == {"base", "other"}
    ranked = one.proposals.scored(one.fits.fit((BASE,)))
    assert [found.effect for _, found in ranked] == ["on_top", "other"]
    assert ranked[0][0] > 100.0 * max(ranked[1][0], 1.0)


@pytest.mark.parametrize("cheap", [False, True])
def test_both_are_found_where_both_are_there(cheap: bool) -> None:
    found = search(Waves(slow=3.0, quick=2.0), cheap).run().final
    assert {c.effect for c in found.candidates} == {"base", "on_top"}
    for c, size in ((BASE, 3.0), (ON_TOP, 2.0)):
        assert found.fit.values[c.parameters[0]] == pytest.approx(size, abs=0.3)


@pytest.mark.parametrize("cheap", [False, True])
def test_what_comes_on_top_is_never_named_alone(cheap: bool) -> None:
    found = search(Waves(quick=5.0), cheap).run().final
    assert all(found.meets_prerequisite(c) for c in found.candidates)


def test_a_fuller_question_is_not_put_plainer_by_what_is_not_borne() -> None:
    fuller = candidate("other", "quick", "quicker")
    found = search(Waves(quick=5.0), True, (BASE, ON_TOP, fuller)).run().final
    assert [c.effect for c in found.candidates] == ["other"]
    assert found.fit.values[fuller.parameters[0]] == pytest.approx(5.0, abs=0.3)


@pytest.mark.parametrize("cheap", [False, True])
@pytest.mark.parametrize("share", [0.95, 0.8])
def test_a_base_that_became_needless_is_not_left_out_alone(monkeypatch: pytest.MonkeyPatch, cheap: bool, share: float) -> None:
    mixed = share * SHAPES["quick"] + np.sqrt(1.0 - share**2) * np.sin(AT / 3.0)
    monkeypatch.setitem(SHAPES, "slow", mixed)
    found = search(Waves(quick=5.0), cheap).run().final
    assert all(found.meets_prerequisite(c) for c in found.candidates)


def test_a_set_asked_twice_is_fitted_for_the_first_who_asks() -> None:
    one = search(Waves(slow=3.0, quick=2.0), cheap=False)
    begun = one.fits.fit(())
    first, other, again = one.fits.fit_all([((BASE, OTHER), begun), ((BASE,), begun), ((OTHER, BASE), begun)])
    assert first is again and first.candidates == (BASE, OTHER)
    assert other.candidates == (BASE,)


def test_threads_change_nothing() -> None:
    library, ends = (BASE, ON_TOP, OTHER), []
    for count in (1, 3):
        with Threads(count) as threads:
            ends.append(Search(Waves(slow=3.0, quick=2.0), (), library, threads).run().final)
    assert ends[0].named == ends[1].named
    assert list(ends[0].fit.values.values()) == list(ends[1].fit.values.values())


@pytest.mark.parametrize(("bound", "names"), [(1e9, 3), (1e-3, 2)], ids=["a machine's own", "another machine's"])
def test_names_are_sought_on_beside_a_hopeless_error_only_while_each_halves_it(bound: float, names: int) -> None:
    shapes = {**SHAPES, "hum": np.sign(np.sin(AT / 1.7))}  # what no name explains
    waves = Waves(bound, shapes, slow=5.0, quick=4.0, quicker=3.0, hum=1.5)
    found = search(waves, True, (BASE, OTHER, candidate("third", "quick"))).run()
    assert len(found.final.candidates) == names


def test_two_that_explain_the_larger_part_of_the_rest_only_together_are_found_together() -> None:
    """Neither alone takes half of what is left beside the first, and a hum without a name keeps all of them above a healthy error."""
    signs = np.random.default_rng(5).choice([-1.0, 1.0], (3, AT.size))
    shapes = {**SHAPES, **dict(zip(("quick", "quicker", "hum"), signs, strict=True))}
    library = (BASE, OTHER, candidate("third", "quick"))
    both = Waves(1.2, shapes, slow=9.5, quick=1.0, quicker=1.0, hum=1.0)
    assert {c.effect for c in search(both, False, library).run().final.candidates} == {"base", "other", "third"}
    one = Waves(1.2, shapes, slow=9.5, quick=1.0, hum=1.4)
    assert {c.effect for c in search(one, False, library).run().final.candidates} == {"base"}


def test_where_none_passes_alone_all_are_asked_together() -> None:
    """Two effects that nearly cancel: alone each explains two per cent of what they leave together."""
    h, one, other = np.random.default_rng(7).choice([-1.0, 1.0], (3, AT.size))
    shapes = {**SHAPES, "quick": h + 0.2 * one, "quicker": h + 0.2 * other}
    library = (BASE, OTHER, candidate("third", "quick"))
    found = search(Waves(1.2, shapes, quick=5.0, quicker=-5.0), False, library).run()
    assert {c.effect for c in found.final.candidates} == {"other", "third"}
    assert found.baseline.fit.sse > 2.0 * found.final.fit.sse
    healthy = search(Waves(2.0, shapes, quick=5.0, quicker=-5.0), False, library).run()
    assert not healthy.final.candidates  # no more is left than a healthy machine leaves


@pytest.mark.parametrize(("sizes", "interrupted"), [({"slow": 9.0, "quick": 4.0}, True), ({"slow": 9.0}, False)])
def test_a_search_ends_where_it_is_asked_to_unless_everything_is_explained(sizes: dict[str, Any], interrupted: bool) -> None:
    library = (BASE, ON_TOP, OTHER)
    stopping = StoppingCriteria(until=partial(_has, "base"))
    found = Search(Waves(**sizes), (), library, stopping=stopping).run()
    assert found.interrupted is interrupted and {c.effect for c in found.final.candidates} == {"base"}


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many findings there are each time that all candidates are asked together."""
    found: list[int] = []
    together = JointSearch.found_together

    def counted(self: JointSearch, now: FittedModel) -> Together:
        found.append(len(now.candidates))
        return together(self, now)

    monkeypatch.setattr(JointSearch, "found_together", counted)
    return found


@pytest.mark.parametrize(("bound", "named"), [(1.2, {"base"}), (1e9, set())])
def test_where_those_of_the_best_scores_leave_the_larger_part_the_next_are_fitted(
    monkeypatch: pytest.MonkeyPatch, asked: list[int], bound: float, named: set[str]
) -> None:
    """Four that mend a third of it promise more than what explains it does; within what a healthy machine leaves nobody looks on."""
    white = np.random.default_rng(4).choice([-1.0, 1.0], (4, AT.size))
    shapes = {**SHAPES, **{f"like{k}": SHAPES["slow"] + white[k] for k in range(4)}}
    library = (*(candidate(f"like{k}", f"like{k}") for k in range(4)), BASE)
    scored = Proposals.scored
    monkeypatch.setattr(Proposals, "scored", lambda own, now: sorted(scored(own, now), key=lambda pair: pair[1] is BASE))
    found = search(Waves(bound, shapes, slow=9.0), False, library).run()
    assert {c.effect for c in found.final.candidates} == named and asked == []


def test_what_was_asked_together_before_is_not_asked_together_again(asked: list[int]) -> None:
    shapes = {**SHAPES, "hum": np.random.default_rng(7).choice([-1.0, 1.0], AT.size)}
    model = Waves(1.2, shapes, slow=9.0, quicker=6.0, hum=4.0)
    before = search(model, False, (BASE,)).run().final
    asked.clear()
    answers: tuple[Callable[[FittedModel], bool], ...] = (lambda _: True, partial(_has, "other"), lambda _: False, partial(_has, "third"))
    for asks, calls in zip(answers, (True, True, False, False), strict=True):
        found = Search(model, (), (BASE, OTHER), start=WarmStart(begun=before, asks_together=asks)).run()
        assert {c.effect for c in found.final.candidates} == {"base", "other"} and bool(asked) is calls
        asked.clear()


def test_what_ends_a_search_is_looked_for_before_all_are_asked_together(asked: list[int]) -> None:
    shapes = {**SHAPES, "hum": np.random.default_rng(7).choice([-1.0, 1.0], AT.size)}
    for last, calls in (("other", []), ("another", [1])):
        stopping = StoppingCriteria(until=partial(_has, last))
        found = Search(Waves(1.2, shapes, slow=9.0, quicker=6.0, hum=4.0), (), (BASE, OTHER), stopping=stopping).run()
        assert found.interrupted is not bool(calls) and asked == calls
        assert {c.effect for c in found.final.candidates} == {"base", "other"}


def test_what_ends_a_search_may_be_found_together(asked: list[int]) -> None:
    """Nearly cancelling, neither of two passes alone; together they are found, and something is left."""
    h, one, other = np.random.default_rng(7).choice([-1.0, 1.0], (3, AT.size))
    shapes = {**SHAPES, "quick": h + 0.2 * one, "quicker": h + 0.2 * other}
    library = (BASE, OTHER, candidate("third", "quick"))
    model = Waves(1.2, shapes, quick=5.0, quicker=-5.0, level=2.0)
    found = Search(model, (), library, stopping=StoppingCriteria(until=partial(_has, "third"))).run()
    assert asked == [0] and found.interrupted and _has("third", found.final)


def _has(effect: str, model: FittedModel) -> bool:
    return any(c.effect == effect for c in model.candidates)


class Weight(Waves):
    """An error that is there all the time: a nominal number far off, or something else that acts in one long stretch."""

    def __init__(self, level: float, wave: float = 0.0):
        super().__init__(slow=wave)
        self._error = self._error - level

    def residual_of(self, plant: PlantParameters) -> np.ndarray:
        waves = {name: value for name, value in plant.sensors.items() if name != "mass"}
        return super().residual_of(replace(plant, sensors=waves)) + 100.0 * (plant.sensors.get("mass", 1.0) - 1.0)


MASS = FreeParameter("mass", "piston", "mass", "1", Target.SENSOR, 0.02, 0.2, 5.0, (1.0, 0.05), neutral=1.0)


def test_a_believed_number_that_alone_explains_an_unchanging_error_is_not_held_back() -> None:
    one = Search(Weight(35.0), (MASS,), (BASE, OTHER), cheap=True).fits.fit(())
    assert one.fit.values[MASS] == pytest.approx(1.35, abs=0.005)


def test_beside_something_else_it_is_held_back() -> None:
    """A wave of thirty cannot be the mass; the mass must not follow its mean."""
    one = Search(Weight(0.0, wave=30.0), (MASS,), (BASE, OTHER), cheap=True)
    alone = float(np.mean(one.fits.model.residual({MASS: 1.0}))) / -100.0
    assert abs(one.fits.fit(()).fit.values[MASS] - 1.0) < 0.7 * abs(alone)


def test_of_what_adds_up_to_one_thing_the_whole_is_fitted_beside_a_part() -> None:
    part, whole = (replace(candidate("lag", *waves), additive=True) for waves in (("slow",), ("slow", "quick")))
    found = search(Waves(slow=5.0), True, (part, whole, OTHER)).run()
    assert [c.form for c in found.final.candidates] == ["slow"]
    assert {q.parameter for q in found.complete[part.key].effect_parameters} == {"lag.slow", "lag.quick"}


class Counted(Waves):
    """Waves that count what is predicted of them."""

    calls = 0

    def residual(self, values: Any, fixed: Any = ()) -> Any:
        type(self).calls += 1
        return super().residual(values, fixed)


@pytest.mark.parametrize("cheap", [False, True])
@pytest.mark.parametrize("asked", [0, 4, 12])
def test_a_search_whose_time_is_up_ends_with_what_it_has(cheap: bool, asked: int) -> None:
    times: list[int] = []

    def is_spent() -> bool:
        times.append(1)
        return len(times) > asked

    Counted.calls = 0
    Search(Counted(slow=3.0, quick=2.0), (), (BASE, ON_TOP, OTHER), cheap=cheap).run()
    whole, Counted.calls = Counted.calls, 0
    found = Search(Counted(slow=3.0, quick=2.0), (), (BASE, ON_TOP, OTHER), cheap=cheap, stopping=StoppingCriteria(is_spent=is_spent)).run()
    assert Counted.calls < whole
    assert found.final.meets_prerequisite(ON_TOP) or ON_TOP not in found.final.candidates
    if asked == 0:
        assert found.final.candidates == () and Counted.calls <= 6


def test_a_search_that_begins_with_what_other_rows_showed_keeps_of_it_what_its_own_bear_out() -> None:
    before = Search(Waves(slow=4.0, quicker=2.0), (), (BASE, OTHER)).run().final
    assert {c.effect for c in before.candidates} == {"base", "other"}
    begun = Search(Waves(slow=3.0, quick=2.0), (), (BASE, ON_TOP, OTHER), start=WarmStart(begun=before)).run()
    assert {c.effect for c in begun.final.candidates} == {"base", "on_top"}
    assert begun.baseline.candidates == () and set(begun.evidence) == {BASE.key, ON_TOP.key}
    assert Search(Waves(), (), (BASE, OTHER), start=WarmStart(begun=before)).run().final.candidates == ()


@pytest.mark.parametrize(("quicker", "names"), [(4.0, ["base", "other"]), (0.0, ["base"])], ids=["more", "nothing"])
def test_beside_a_model_that_changed_since_what_shows_is_found_and_what_stands_keeps_its_form(
    quicker: float, names: list[str]
) -> None:
    """A plainer form of the standing effect would explain nearly as much: a search from the beginning takes it."""
    fuller = candidate("base", "slow", "quick")
    one = search(Waves(slow=9.0, quick=1.0, quicker=quicker), False, (BASE, OTHER, fuller))
    bare = one.fits.fit(())
    found = SearchResult(bare, one.fits.refined(one.fits.fit((fuller,), bare)), stands_for={("dead_volume", "piston"): ("base",)})
    more = one.shown_beside(found, one.fits)
    assert [c.effect for c in more.final.candidates] == names and more.final.candidates[0] == fuller
    assert more.stands_for == found.stands_for and (more is found) is (len(names) == 1)
