"""A finished search is assessed: each finding against leaving it out, against its rivals, and what nearly came in."""

from __future__ import annotations

from dataclasses import replace

import pytest
from diagnosis.waves import BASE, OTHER, RATE, SHAPES, SIZE, Ringing, Waves, candidate

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy.budgets import FINALISTS
from exo_sim.diagnosis.selection.assessment import _begun_at, assess
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
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


FAULT = replace(candidate("sensor_delay", "quicker"), kind=Kind.SENSOR)
#: Numbers of the rig from whose nominal values no fit finds back to what rings.
NUMBERS = tuple(replace(q, neutral=neutral, prior=None) for q, neutral in ((SIZE, 2.0), (RATE, 6.0)))


def test_what_may_stand_in_the_place_of_a_sensors_fault_is_begun_at_the_model_with_that_as_well() -> None:
    """Before the fault was found another number had gone astray, and a twin that begins there stays there."""
    fits = ModelFits(Ringing(6.0, 20.4, quicker=5.0), NUMBERS)
    baseline = fits.fit(())
    assert abs(baseline.fit.values[NUMBERS[1]] - 20.4) > 1.0
    final = fits.refined(fits.fit((FAULT,), FittedModel.at(dict(zip(NUMBERS, (6.0, 20.4), strict=True)))))
    twin = candidate("twin", "quicker")
    found = assess(final, fits, Comparisons(fits, baseline, 2, 0.0), Proposals(fits, (FAULT, twin), 0.0))
    assert {one.effect: worse for one, worse in found.rivals[FAULT.key]}["twin"] == pytest.approx(0.0, abs=0.5)


def test_of_two_first_looks_that_both_lead_far_off_the_better_is_kept() -> None:
    fits, level = ModelFits(Ringing(6.0, 20.4, quicker=30.0), NUMBERS), candidate("level", "level")
    final = fits.refined(fits.fit((FAULT,)))
    good = ModelFits(fits.model, NUMBERS)
    first = fits.look((level,), good.refined(good.fit((), FittedModel.at(dict(zip(NUMBERS, (6.0, 20.4), strict=True))))))
    assert abs(final.fit.values[NUMBERS[1]] - 20.4) > 1.0
    assert _begun_at(final, first, fits) is first


def test_beside_many_findings_nothing_crowds_out_what_is_declared_to_look_like_a_sensors_fault() -> None:
    """Five effects that nobody declares do more of what the fault does than the lag that it is mistaken for."""
    shapes = {**SHAPES, "late": SHAPES["quicker"] + 0.3 * SHAPES["quick"], "less": SHAPES["quicker"] + 0.5 * SHAPES["slow"]}
    findings = (FAULT, BASE, candidate("second", "quick"), candidate("third", "level"))
    lag, crowd = candidate("valve_lag", "less"), tuple(candidate(f"crowd_{n}", "late") for n in range(FINALISTS + 1))
    fits = ModelFits(Waves(1.0, shapes, quicker=6.0, slow=4.0, quick=4.0, level=4.0), ())
    final = fits.refined(fits.fit(findings))
    asked = Proposals(fits, (*findings, *crowd, lag), 0.0)
    assert final.is_large
    found = assess(final, fits, Comparisons(fits, fits.fit(()), len(crowd), 0.0), asked)
    rivals = {one.effect for one, _ in found.rivals[FAULT.key]}
    assert "valve_lag" in rivals and len(rivals) == FINALISTS + 1
