"""Comparisons of fitted models on white noise and waves, where every quantity has a closed form."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from diagnosis.waves import AT, BASE, OTHER, SHAPES, Waves, parameter

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.policy import acceptance
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.model_fits import ModelFits

SIZE = 3.0


@pytest.fixture
def fits() -> ModelFits:
    return ModelFits(Waves(slow=SIZE), ())


def compared(fits: ModelFits, *chosen: Candidate) -> tuple[Comparisons, FittedModel, FittedModel]:
    baseline = fits.fit(())
    return Comparisons(fits, baseline, 10, 0.0), baseline, fits.fit(chosen, baseline)


def test_evidence_is_the_drop_of_the_squared_error(fits: ModelFits) -> None:
    comparisons, bare, full = compared(fits, BASE)
    evidence = comparisons.evidence(bare, full)
    explained = (bare.fit.sse - full.fit.sse) / (bare.fit.sse - AT.size)
    assert evidence.share == pytest.approx(explained, rel=0.05) and evidence.share > 0.9
    assert evidence.log10_odds > acceptance.LEAST_ODDS
    assert comparisons.accepts(bare, full)


def test_what_explains_nothing_is_not_accepted(fits: ModelFits) -> None:
    comparisons, bare, full = compared(fits, OTHER)
    assert not comparisons.accepts(bare, full)


def test_a_parameter_costs_half_the_logarithm_of_the_independent_rows(fits: ModelFits) -> None:
    comparisons, _, full = compared(fits, BASE)
    rows = AT.size / fits.correlation_time(full.fit.residual)
    assert comparisons.price((full,)) == pytest.approx(0.5 * math.log(rows))


def test_the_ranking_charges_for_parameters(fits: ModelFits) -> None:
    comparisons, bare, full = compared(fits, BASE)
    richer = fits.fit((BASE, OTHER), full)
    assert [model.candidates for model in comparisons.ranked((bare, richer, full))] == [(BASE,), (BASE, OTHER), ()]


def test_clean_is_as_small_as_the_noise_and_explained_counts_from_the_baseline(fits: ModelFits) -> None:
    comparisons, bare, full = compared(fits, BASE)
    assert comparisons.is_clean(full) and not comparisons.is_clean(bare)
    assert comparisons.explains(full, full, 0.999) and not comparisons.explains(bare, full, 0.01)
    assert comparisons.is_as_good(full, fits.fit((BASE, OTHER), full)) and not comparisons.is_as_good(bare, full)
    assert np.sum(SHAPES["slow"] ** 2) * SIZE**2 == pytest.approx(bare.fit.sse - full.fit.sse, rel=0.2)


@pytest.mark.parametrize("ended_at", [0.4 * SIZE, SIZE])
def test_the_baseline_is_the_best_fit_of_the_nuisance_parameters_that_is_known(ended_at: float) -> None:
    """They ended short of their optimum, and a fit that left an effect out again went there."""
    free = parameter("nuisance", "slow", (0.0, 10.0))
    fits = ModelFits(Waves(slow=SIZE), (free,))
    best = fits.fit(())
    values = {free: ended_at * best.fit.values[free] / SIZE}
    short = FittedModel((), replace(best.fit, values=values, residual=fits.model.residual(values)))
    comparisons = Comparisons(fits, short, 10, 0.0)
    assert comparisons.moves_baseline() is (ended_at < SIZE)
    assert comparisons.baseline.fit.sse == pytest.approx(best.fit.sse, rel=1e-3)
    assert not comparisons.moves_baseline()
