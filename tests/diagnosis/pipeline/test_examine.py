"""One round put together: an effect of a shared part stands once, where its odds are greatest; doubtful remainders are taken back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.findings import Finding, Kind
from exo_sim.diagnosis.pipeline import examine
from exo_sim.diagnosis.pipeline.plan import Results
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult


def result(name: str, **odds: float) -> SubsystemResult[waves.Waves]:
    model = waves.Waves()
    final = FittedModel((), Fit((), {}, np.zeros(4), np.zeros((4, 0))))
    findings = tuple(Finding(effect, "supply", Kind.MISSING_PHYSICS, "", {}, value, 0.5) for effect, value in odds.items())
    return SubsystemResult(name, model, ModelFits(model, ()), SearchResult(final, final), final, findings=findings)


@pytest.mark.parametrize(("first", "second", "kept"), [(9.0, 4.0, ["a"]), (4.0, 9.0, ["b"])])
def test_an_effect_of_the_shared_supply_stands_where_its_odds_are_greatest(first: float, second: float, kept: list[str]) -> None:
    results = Results(gas=(result("a", supply_droop=first, other=1.0), result("b", supply_droop=second)))  # type: ignore[arg-type]
    shared = examine._shared_once(results)
    assert [one.name for one in shared.all for f in one.findings if f.name == "supply_droop"] == kept
    assert "other" in [f.name for f in shared.all[0].findings]


def test_a_search_that_was_interrupted_is_gone_on_with_once_the_forces_are_known(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = result("a")
    ended = replace(whole, search=replace(whole.search, interrupted=True))

    class Found:
        def __init__(self, one: SubsystemResult[waves.Waves]):
            self.results = Results(gas=(one,))  # type: ignore[arg-type]

    monkeypatch.setattr(examine, "friction_behind_soft_transmissions", lambda gas, motion: {})
    monkeypatch.setattr(examine, "_friction_behind_hidden_give", lambda one: {})
    assert examine.friction_to_add(Found(ended)) == {}  # type: ignore[arg-type]
    assert examine.friction_to_add(Found(whole)) is None  # type: ignore[arg-type]
