"""A finished search is assessed: each finding against leaving it out, against its rivals, and what nearly came in."""

from __future__ import annotations

import pytest
from diagnosis.waves import BASE, OTHER, SHAPES, Waves, candidate

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.selection.assessment import assess
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.proposals import Proposals

TWIN = candidate("twin", "slow")


def assessed(*asked: Candidate, spent: bool = False, **sizes: float) -> SearchResult:
    fits = ModelFits(Waves(1.0, SHAPES, **sizes), (), cheap=True)
    baseline = fits.fit(())
    comparisons = Comparisons(fits, baseline, len(asked), 0.0)
    return assess(fits.fit((BASE,), baseline), fits, comparisons, Proposals(fits, asked, 0.0), spent)


def test_leaving_a_finding_out_costs_what_it_explained() -> None:
    found = assessed(BASE, OTHER, slow=3.0)
    evidence = found.evidence[BASE.key]
    assert evidence.log10_odds > 100.0 and evidence.share > 0.9
    assert found.final.candidates == (BASE,) and found.baseline.candidates == ()


def test_a_twin_is_a_rival_that_is_no_worse_and_another_wave_one_that_is() -> None:
    found = assessed(BASE, TWIN, OTHER, slow=3.0)
    rivals = {one.effect: worse for one, worse in found.rivals[BASE.key]}
    assert rivals["twin"] == pytest.approx(0.0, abs=1e-6) and rivals["other"] > 100.0
    assert [one.effect for one, _ in found.rivals[BASE.key]] == ["twin", "other"]


def test_runners_up_are_ordered_by_what_they_explain_of_the_rest() -> None:
    found = assessed(BASE, OTHER, candidate("weak", "level"), slow=3.0, quicker=1.0)
    assert next(one.effect for one, _ in found.runners_up) == "other"
    shares = [share for _, share in found.runners_up]
    assert shares == sorted(shares, reverse=True) and shares[0] > 0.5


def test_where_the_time_is_spent_nothing_more_is_fitted() -> None:
    found = assessed(BASE, TWIN, OTHER, slow=3.0, spent=True)
    assert found.rivals[BASE.key] == () and found.runners_up == () and BASE.key in found.evidence
