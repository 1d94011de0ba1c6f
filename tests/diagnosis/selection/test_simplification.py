"""Simplification: what is not worth its parameters goes, and with it what stands on it."""

from __future__ import annotations

from dataclasses import replace

import pytest
from diagnosis.waves import BASE, ON_TOP, OTHER, Waves, candidate, parameter

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import FittedModel, is_at_bound
from exo_sim.diagnosis.selection.search import Search
from exo_sim.diagnosis.selection.simplification import Simplification


def test_pruning_keeps_what_another_stands_on() -> None:
    one = Search(Waves(quick=5.0), (), (BASE, ON_TOP, OTHER))
    comparisons = Comparisons(one.fits, one.fits.fit(()), 3, 0.0)
    simplification = Simplification(one.fits, comparisons, one.proposals)
    kept = simplification.pruned(one.fits.fit((BASE, ON_TOP)))
    assert {c.effect for c in kept.candidates} == {"base", "on_top"}
    assert simplification.pruned(one.fits.fit((BASE, OTHER))).candidates == ()


RICH, POOR = candidate("wide", "slow", "quick"), candidate("wide", "slow")


class OnlyRich(Comparisons):
    """Comparisons that accept an effect in its richer form alone."""

    def accepts(self, without: FittedModel, with_it: FittedModel, stands: bool = False) -> bool:
        return POOR not in with_it.candidates


@pytest.mark.parametrize(("kind", "kept"), [(Comparisons, POOR), (OnlyRich, RICH)], ids=["accepted in it", "not accepted in it"])
def test_a_simpler_form_takes_a_place_only_where_the_finding_is_accepted_in_it(kind: type[Comparisons], kept: Candidate) -> None:
    """The second wave is hardly there: the first alone explains as much."""
    one = Search(Waves(slow=4.0, quick=0.02), (), (RICH, POOR))
    simplification = Simplification(one.fits, kind(one.fits, one.fits.fit(()), 2, 0.0), one.proposals)
    rich = one.fits.fit((RICH,))
    assert simplification.tidied(rich).candidates == (kept,)
    assert simplification.settled(rich).candidates == (kept,)


WHOLE, OTHER_WAY = candidate("wide", "slow", "quick", "quicker"), candidate("wide", "slow", "quicker")


def simplest(kind: type[Comparisons], waves: Waves, now: Candidate, *offered: Candidate) -> tuple[Candidate, ...]:
    """Return the candidates of the simplest model with these forms on offer."""
    one = Search(waves, (), (now, *offered))
    simplification = Simplification(one.fits, kind(one.fits, one.fits.fit(()), 3, 0.0), one.proposals)
    return simplification._simplest(one.fits.fit((now,))).candidates


def test_a_form_in_which_the_finding_would_be_lost_does_not_bar_a_richer_one_that_is_simpler_all_the_same() -> None:
    assert simplest(OnlyRich, Waves(slow=4.0, quick=0.02, quicker=0.02), WHOLE, RICH, POOR) == (RICH,)
    assert simplest(Comparisons, Waves(slow=4.0, quick=0.02, quicker=0.02), WHOLE, RICH, POOR) == (POOR,)


class None_(Comparisons):
    """Comparisons that accept nothing."""

    def accepts(self, without: FittedModel, with_it: FittedModel, stands: bool = False) -> bool:
        return False


def test_what_is_accepted_in_no_form_is_not_lost_in_a_simpler_one() -> None:
    assert simplest(None_, Waves(slow=4.0, quick=0.02), RICH, POOR) == (POOR,)


class NotOtherWay(Comparisons):
    """Comparisons that do not accept an effect in one form of two parameters."""

    def accepts(self, without: FittedModel, with_it: FittedModel, stands: bool = False) -> bool:
        return OTHER_WAY not in with_it.candidates


def test_a_form_with_as_many_parameters_that_explains_more_is_not_asked_whether_it_is_accepted() -> None:
    assert simplest(NotOtherWay, Waves(slow=4.0, quicker=4.0), RICH, OTHER_WAY) == (OTHER_WAY,)


CLOSED = replace(candidate("critical_ratio", "slow"), parameters=(replace(parameter("critical_ratio", "slow"), high=2.0),))
OPEN = candidate("critical_ratio", "slow", "quick")


@pytest.mark.parametrize(("forms", "kept"), [((CLOSED, OPEN), OPEN), ((CLOSED,), CLOSED)], ids=["another form", "no other form"])
def test_a_finding_that_ended_at_a_bound_takes_another_form_of_it_that_does_not(forms: tuple[Candidate, ...], kept: Candidate) -> None:
    one = Search(Waves(slow=4.0, quick=3.0), (), (*forms, OTHER))
    simplification = Simplification(one.fits, Comparisons(one.fits, one.fits.fit(()), 3, 0.0), one.proposals)
    ended = one.fits.fit((CLOSED,))
    assert is_at_bound(CLOSED, ended)
    assert simplification.off_bounds(ended).candidates == (kept,)
    clear = one.fits.fit((OTHER,))
    assert simplification.off_bounds(clear) is clear
