"""An unknown effect: where it acts, on what it depends, and its curve."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy.probability import MAY_BE_NIL
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import effect_of, spread_of_size, unknown_effects


def result(model: waves.Waves, has_unknown: bool = False) -> SubsystemResult[waves.Waves]:
    final = FittedModel((), Fit((), {}, model.residual({}), np.zeros((model.size, 0))))
    return SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final, has_unknown=has_unknown)


def test_it_says_where_it_acts_and_on_what_it_depends() -> None:
    one = result(waves.Waves(slow=5.0), has_unknown=True)
    (effect,) = unknown_effects([one])
    finding = effect.finding
    assert (finding.kind, finding.where, finding.depends_on) == (Kind.UNKNOWN, "piston", ("slide.position",))
    assert "sum of waves of piston" in finding.says and "follows slide.position" in finding.says
    assert finding.curve is not None and finding.curve["values"] == [-1.0, 1.0]
    assert finding.log10_odds > 3.0
    assert effect_of([effect], one) is effect


def test_without_one_there_is_none() -> None:
    one = result(waves.Waves())
    assert unknown_effects([one]) == () and effect_of([], one) is None


def test_its_size_is_as_sure_as_independent_values_make_it() -> None:
    (effect,) = unknown_effects([result(waves.Waves(slow=5.0), has_unknown=True)])
    size = effect.finding.parameters["size"]
    assert size.low < size.value < size.high and (size.low > 0.0 or effect.finding.confidence <= MAY_BE_NIL)
    low, high = spread_of_size(200.0)
    assert (low, high) == (pytest.approx(0.902, abs=1e-3), pytest.approx(1.098, abs=1e-3))
    assert spread_of_size(1.0)[0] == 0.0
