"""What a search tries next: what the score test promises, and neither too much of one effect nor what does nothing."""

from __future__ import annotations

from dataclasses import replace

import pytest
from diagnosis.waves import AT, BASE, OTHER, SHAPES, Waves, candidate

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy.budgets import FORMS_OF_ONE, LARGE
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.proposals import Proposals

RICH, PLAIN = candidate("both", "slow", "quick"), candidate("both", "slow")


def proposals(*candidates: Candidate, cheap: bool = False, **sizes: float) -> tuple[Proposals, FittedModel]:
    fits = ModelFits(Waves(1e9, SHAPES, **sizes), (), cheap=cheap)
    return Proposals(fits, candidates, 0.0), fits.fit(())


def test_a_linear_candidate_promises_what_a_fit_of_it_gains() -> None:
    found, bare = proposals(BASE, OTHER, slow=3.0, quicker=1.0)
    promised = {one.effect: score for score, one in found.scored(bare)}
    assert [one.effect for _, one in found.scored(bare)] == ["base", "other"]
    for one in (BASE, OTHER):
        gained = bare.fit.sse - found.fits.fit((one,), bare).fit.sse
        assert promised[one.effect] == pytest.approx(gained, rel=0.02)


def test_only_what_could_be_accepted_is_added_but_every_alternative_is_named() -> None:
    found, bare = proposals(BASE, OTHER, slow=3.0)
    assert [one.effect for one in found.additions(bare)] == ["base"]
    assert [one.effect for one in found.alternatives(bare)] == ["base", "other"]
    assert not found.promise_enough(0.001 * AT.size, bare)


def test_the_next_scores_are_of_other_effects_than_the_first() -> None:
    waves = ("slow", "quick", "quicker", "level")
    every = [candidate(f"effect{k}", *pair) for k, pair in enumerate(zip(waves, (*waves[1:], "slow"), strict=True))]
    last = candidate("last", "quicker")
    found, bare = proposals(*every, last, candidate("effect0", "slow"), slow=9.0, quick=8.0, quicker=5.0, level=9.0)
    first, later = found.additions(bare), found.additions(bare, later=True)
    assert {one.effect for one in first} == {"effect0", "effect1", "effect2", "effect3"} and later == [last]


def test_few_forms_of_one_effect_are_fitted_at_a_time() -> None:
    forms = [candidate("base", wave) for wave in ("slow", "quick", "quicker", "level")]
    found, bare = proposals(*forms, OTHER, slow=3.0, quick=2.0, quicker=2.0, level=2.0)
    picked = found.alternatives(bare, 4)
    assert sum(one.effect == "base" for one in picked) == FORMS_OF_ONE and OTHER in picked


def test_replacements_are_other_forms_whose_prerequisite_is_there() -> None:
    orphan = candidate("both", "quicker", prerequisite="absent")
    found, bare = proposals(RICH, PLAIN, OTHER, orphan, slow=3.0)
    assert found.replacements(PLAIN, bare) == [RICH]


def test_in_a_large_model_only_what_is_asked_at_once_of_a_switched_valve_is_richer() -> None:
    """Five others were found beside a 5/3 valve's lag as a time constant, and nobody asked whether it closes later than it opens."""

    def lag(*names: str) -> Candidate:
        made = candidate("valve_lag", *("slow", "quick")[: len(names)])
        parameters = tuple(replace(q, parameter=name) for q, name in zip(made.parameters, names, strict=True))
        return replace(made, form="+".join(names), parameters=parameters)

    plain, thrown, other = lag("time_constant"), lag("delay", "closing_delay"), lag("time_constant", "delay")
    found, bare = proposals(plain, thrown, other)
    large = replace(bare, candidates=(plain, *(candidate(f"effect{k}", "slow") for k in range(LARGE))))
    assert large.is_large and not bare.is_large
    assert found.replacements(plain, bare) == [thrown, other] and found.replacements(plain, large) == [thrown]


def test_another_error_of_the_same_column_may_stand_in_the_place_of_one() -> None:
    scale, bias = (replace(candidate(effect, "slow"), kind=Kind.SENSOR) for effect in ("sensor_scale", "sensor_bias"))
    elsewhere = replace(bias, where="slide.position")
    found, bare = proposals(scale, bias, elsewhere, BASE, slow=3.0)
    assert found.replacements(scale, bare) == [bias]
    both = replace(bare, candidates=(scale, bias))
    assert found.replacements(scale, both) == []


def test_simpler_forms_have_fewer_parameters_and_those_that_are_kept() -> None:
    bias = Candidate("both", "piston", "bias", RICH.parameters[1:], ((1.0,),))
    slow = Candidate("both", "piston", "slow", RICH.parameters[:1], ((1.0,),))
    found, bare = proposals(RICH, slow, bias, OTHER, slow=3.0)
    assert found.simpler(RICH, bare, set()) == [slow, bias]
    assert found.simpler(RICH, bare, {"both.quick"}) == [bias]
    assert found.fullest(slow) == RICH and found.fullest(OTHER) == OTHER


def test_beside_many_findings_only_declared_twins_succeed_physics_but_anything_a_sensors_fault() -> None:
    fault, lag = replace(candidate("sensor_delay", "quicker"), kind=Kind.SENSOR), candidate("valve_lag", "slow")
    findings = (fault, lag, candidate("second", "quick"), candidate("third", "level"))
    found, _ = proposals(*findings, candidate("line_restriction", "slow"), candidate("fourth", "slow"), quicker=6.0, slow=4.0)
    whole = found.fits.fit(findings)
    for finding, expected in ((fault, {"line_restriction", "fourth"}), (lag, {"line_restriction"})):
        without = found.fits.fit(whole.without(finding), whole)
        assert {one.effect for _, one in found.successors(finding, without, whole)} == expected
