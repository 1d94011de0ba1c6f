"""Where the mismatch is, and what of it remains."""

from __future__ import annotations

import pytest
from diagnosis import waves

from exo_sim.diagnosis.outcome.localisation import located, unexplained
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.search import Search
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import unknown_effects


def result(where: str, model: waves.Waves, *candidates: waves.Candidate) -> SubsystemResult[waves.Waves]:
    model.where = where
    search = Search(model, (), candidates, cheap=True)
    return decide(where, model, search.fits, search.run())


def test_shares_are_those_of_the_squared_error_above_the_noise() -> None:
    found = located([result("hip", waves.Waves(slow=1.0), waves.BASE), result("knee", waves.Waves(slow=3.0), waves.BASE)])
    assert [place.where for place in found] == ["knee", "hip"]
    assert found[0].share == pytest.approx(0.9, abs=0.04) and sum(place.share for place in found) == pytest.approx(1.0)
    assert found[0].equation == "sum of waves" and found[0].noise == 1.0


def test_a_balance_that_closes_is_not_listed() -> None:
    found = located([result("hip", waves.Waves(), waves.BASE), result("knee", waves.Waves(slow=8.0), waves.BASE)])
    assert [place.where for place in found] == ["knee"]
    assert located([]) == ()


def test_what_is_named_leaves_nothing_unexplained() -> None:
    one = result("hip", waves.Waves(slow=3.0), waves.BASE)
    assert one.named and unexplained([one], ()) == ()


def test_what_is_unknown_stays_with_the_variable_it_depends_on() -> None:
    one = result("hip", waves.Waves(1.5, slow=6.0, quick=6.0), waves.candidate("nothing", "level"))
    (rest,) = unexplained([one], unknown_effects([one]))
    assert (rest.where, rest.depends_on) == ("hip/sum of waves", ("slide.position",)) and rest.share > 0.9
    assert rest.by_curve == rest.as_dict()["by_curve"] == 0.9
    (plain,) = unexplained([one], ())
    assert plain.by_curve == 0.0 and "by_curve" not in plain.as_dict()
