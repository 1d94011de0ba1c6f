"""A plan asks for what has not been refuted; results keep only what is to be kept, and nothing is written into them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.findings import Finding, Kind
from exo_sim.diagnosis.nominal_numbers import DEAD_VOLUME
from exo_sim.diagnosis.pipeline.plan import Plan, Results
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nuisance_calibration import Deviation
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult


def result(name: str, *found: str) -> SubsystemResult[waves.Waves]:
    model = waves.Waves()
    final = FittedModel((), Fit((), {}, np.zeros(4), np.zeros((4, 0))))
    findings = tuple(Finding(effect, name, Kind.MISSING_PHYSICS, "", {}, 9.0, 0.5) for effect in found)
    return SubsystemResult(name, model, ModelFits(model, ()), SearchResult(final, final), final, findings=findings)


@pytest.mark.parametrize(("refuted", "asked"), [({}, ["base", "other"]), ({("base", "piston"): "not borne out"}, ["other"]),
                                                ({("base", "elsewhere"): ""}, ["base", "other"])])  # fmt: skip
def test_what_was_refuted_at_a_place_is_not_asked_there(refuted: dict[tuple[str, str], str], asked: list[str]) -> None:
    plan = Plan(Split({}), refuted)
    assert [one.effect for one in plan.without_refuted([waves.BASE, waves.OTHER])] == asked


def test_results_keep_the_findings_that_are_to_be_kept_in_their_order() -> None:
    results = Results(gas=(result("a", "leak", "heat"),), motion=(result("b", "drag"),))  # type: ignore[arg-type]
    assert [one.name for one in results.all] == ["a", "b"]
    kept = results.keeping(lambda one, finding: finding.name != "leak" and one.name == "a")
    assert [[f.name for f in one.findings] for one in kept.all] == [["heat"], []]
    assert [[f.name for f in one.findings] for one in results.all] == [["leak", "heat"], ["drag"]]
    assert replace(results, supply=()).all == results.all


def test_a_dead_volume_holds_a_hose_again_that_is_not_kept() -> None:
    dead = FreeParameter(DEAD_VOLUME, "a", "dead_volume_1", "1", Target.FACTOR, 0.1, 0.05, 10.0, (1.0, 0.15), neutral=1.0)
    counted = Deviation(dead, 0.1, 0.02, counted_in="line_restriction", with_it=0.98)
    results = Results(gas=(replace(result("a", "line_restriction", "heat"), deviations=(counted,)),))  # type: ignore[arg-type]
    assert results.keeping(lambda _, finding: finding.name != "heat").gas[0].deviations == (counted,)
    assert results.keeping(lambda _, finding: finding.name == "heat").gas[0].deviations == ()
