"""Further forms of what was found: taken where the data need them, asked nowhere else, begun where the poorer form ended."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis.waves import BASE, ON_TOP, OTHER, Waves, candidate, parameter

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import FittedModel, reach_of_bound
from exo_sim.diagnosis.selection.further_forms import with_further_forms
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.search import Search

FURTHER = replace(candidate("base", "slow", "quick"), starts=((9.0, 0.5), (9.0, -0.5)), further=frozenset({"base.quick"}))


def asked(model: Waves, found: Candidate, further: Candidate = FURTHER) -> tuple[FittedModel, FittedModel, Search]:
    """Return a model with one finding, and the same in further forms where these are accepted."""
    one = Search(model, (), (BASE, OTHER, further))
    bare = one.fits.fit(())
    now = one.fits.refined(one.fits.fit((found,), bare))
    return now, with_further_forms(now, one.fits, Comparisons(one.fits, bare, 3, 0.0), one.proposals), one


def test_a_law_goes_on_where_the_data_need_it() -> None:
    now, richer, one = asked(Waves(slow=8.0, quick=4.0), BASE)
    assert [c.form for c in richer.candidates] == ["slow+quick"]
    assert abs(richer.fit.values[parameter("base", "quick")] - 4.0) < 0.3
    begun = one.proposals.further(BASE, now)
    assert [start[0] for start in begun[0].starts] == [now.fit.values[parameter("base", "slow")]] * 2


def test_a_law_goes_on_though_the_poorer_form_explains_nearly_all_that_was_missing() -> None:
    """What is left counts, not how little of all that was missing it is."""
    slow = replace(parameter("base", "slow"), high=1e3)
    found, further = replace(BASE, parameters=(slow,)), replace(FURTHER, parameters=(slow, parameter("base", "quick")))
    now, richer, one = asked(Waves(slow=100.0, quick=2.0), found, further)
    assert one.fits.fit(()).fit.sse - now.fit.sse > 0.999 * (one.fits.fit(()).fit.sse - richer.fit.sse)
    assert [c.form for c in richer.candidates] == ["slow+quick"]


def test_a_law_stays_as_it_was_where_nothing_is_left() -> None:
    now, richer, _ = asked(Waves(slow=8.0), BASE)
    assert richer is now


@pytest.mark.parametrize(("quick", "goes_on"), [(1.1, True), (0.0, False)])
def test_a_clean_law_goes_on_where_another_effect_would_take_a_place(quick: float, goes_on: bool) -> None:
    now, richer, one = asked(Waves(slow=8.0, quick=quick), BASE)
    assert richer is now
    comparisons = Comparisons(one.fits, one.fits.fit(()), 3, 0.0)
    assert (with_further_forms(now, one.fits, comparisons, one.proposals, instead=True) is not now) is goes_on


def test_a_law_stays_as_it_was_where_the_further_form_does_not_help() -> None:
    now, richer, _ = asked(Waves(slow=8.0, quicker=4.0), BASE)
    assert richer is now


def test_what_ended_at_a_bound_was_not_found() -> None:
    now, richer, _ = asked(Waves(slow=8.0, quick=40.0), BASE)
    assert richer is now


def test_a_further_form_is_no_candidate_and_asked_of_no_other_effect() -> None:
    now, richer, one = asked(Waves(slow=8.0, quick=4.0, quicker=6.0), OTHER)
    assert richer is now
    assert FURTHER not in one.proposals.candidates
    elsewhere = replace(FURTHER, further=frozenset())
    assert one.proposals.further(elsewhere, now) == []


@pytest.mark.parametrize(("found", "quick", "acts"), [(BASE, 4.0, True), (BASE, 0.0, False), (OTHER, 4.0, False)])
def test_by_what_law_a_finding_acts_is_asked_though_a_healthy_machine_leaves_as_much(found: Candidate, quick: float, acts: bool) -> None:
    """What a law gets wrong ends in the numbers of what was found; another name, which is no law of it, is not asked here."""
    law = replace(ON_TOP, is_law=True)
    one = Search(Waves(bound=1e9, slow=8.0, quick=quick, quicker=4.0), (), (BASE, OTHER, law))
    bare = one.fits.fit(())
    now = one.fits.refined(one.fits.fit((found,), bare))
    richer = with_further_forms(now, one.fits, Comparisons(one.fits, bare, 3, 0.0), one.proposals)
    assert richer.candidates == ((found, law) if acts else (found,))


def test_a_search_ends_with_the_further_form() -> None:
    found = Search(Waves(slow=8.0, quick=4.0), (), (BASE, OTHER, FURTHER)).run()
    assert [c.form for c in found.final.candidates] == ["slow+quick"]


class Bent(Waves):
    """Beyond a size below nil a wave cancels the other way: a fit that begins there ends elsewhere."""

    def residual_of(self, plant: PlantParameters) -> np.ndarray:
        residual = self._error.copy()
        for name, value in plant.sensors.items():
            if name == "base.quick":
                value = -1.5 * value if value < 0.0 else value / (1.0 + value)
            residual = residual + value * self.shapes[name.split(".")[-1]]
        return residual


@pytest.mark.parametrize("cheap", [False, True])
@pytest.mark.parametrize("starts", [((8.0, 0.5), (8.0, -0.5)), ((8.0, -0.5), (8.0, 0.5))])
def test_each_start_is_fitted_whatever_the_number_of_threads(cheap: bool, starts: tuple[tuple[float, float], ...]) -> None:
    def found(threads: Threads) -> FittedModel:
        fits = ModelFits(Bent(slow=8.0, quick=4.0), (), threads, cheap)
        now = fits.refined(fits.fit((BASE,), fits.fit(())))
        ended = fits.fit_from_each([(replace(FURTHER, starts=(start,)),) for start in starts], now)
        assert ended is not None
        return ended

    with Threads(2) as two:
        ended = [found(SERIAL), *(found(two) for _ in range(3))]
    assert all(one.fit.sse == ended[0].fit.sse for one in ended)
    assert ended[0].fit.sse < 1.2 * ended[0].fit.residual.size
    assert ended[0].fit.values[parameter("base", "quick")] < 0.0


def test_a_number_that_spans_decades_is_at_its_end_only_near_it() -> None:
    """A twentieth of the scale is a hundred times the low bound."""
    size = replace(parameter("base", "quick"), low=1e-4, high=1e3, logarithmic=True)
    assert reach_of_bound(size, 2e-4) < 1e-4 < reach_of_bound(replace(size, low=-1.0, logarithmic=False), 2e-4)
