"""Imperfections that no data show are none in the model that is accepted."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.nominal_numbers import ZERO
from exo_sim.diagnosis.policy.healthy import ZERO_MODEL
from exo_sim.diagnosis.policy.off_nominal import MODEL_SHARE
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.unneeded_nuisances import error_of_model, is_imperfection, unneeded_of, without_unneeded

LEVEL = waves.parameter("offset", "level", (0.0, 5.0))
QUICK, QUICKER = (waves.parameter("edges", wave, (0.0, 5.0)) for wave in ("quick", "quicker"))


def fitted(model: waves.Waves, *nuisances: FreeParameter, candidates: tuple[waves.Candidate, ...] = ()) -> tuple[ModelFits, FittedModel]:
    fits = ModelFits(model, nuisances)
    return fits, fits.refined(fits.fit(candidates))


def test_what_is_there_stays_and_what_is_not_is_at_zero() -> None:
    fits, model = fitted(waves.Waves(level=2.0), LEVEL, QUICK, QUICKER)
    assert unneeded_of(fits, model) == {QUICK, QUICKER}
    plain = without_unneeded(fits, model)
    assert plain.fit.values[QUICK] == plain.fit.values[QUICKER] == 0.0 and plain.fit.values[LEVEL] == pytest.approx(2.0, abs=0.15)
    np.testing.assert_allclose(plain.fit.residual, fits.model.residual(plain.fit.values))


def test_an_effect_at_a_place_stays_with_all_its_parameters_or_with_none() -> None:
    fits, model = fitted(waves.Waves(quick=2.0), LEVEL, QUICK, QUICKER)
    assert unneeded_of(fits, model) == {LEVEL}


def test_how_uncertain_numbers_are_stays() -> None:
    fits, model = fitted(waves.Waves(slow=3.0), LEVEL, QUICK, candidates=(waves.BASE,))
    plain = without_unneeded(fits, model)
    assert fits.standard_errors(plain) == pytest.approx(fits.standard_errors(model), rel=0.05)
    assert plain.candidates == model.candidates


def test_believed_numbers_and_found_effects_are_no_imperfections() -> None:
    factor = waves.parameter("flow_capacity", "level", (1.0, 0.1))
    found = waves.candidate("edges", "quick")
    fits, model = fitted(waves.Waves(level=1.0, quick=0.05), factor, QUICKER, candidates=(found,))
    assert not is_imperfection(factor) and unneeded_of(fits, model) == frozenset()


def test_a_zero_within_what_laws_get_wrong_is_none() -> None:
    zero = FreeParameter(ZERO, "piston", "zero.level", "Pa", LEVEL.target, 1.0, -10.0, 10.0, (0.0, 5.0))
    fits, model = fitted(waves.Waves(level=2.0), zero)
    assert unneeded_of(fits, model) == frozenset() and unneeded_of(fits, model, structural=4.0) == {zero}
    assert error_of_model(zero, 4.0) == 4.0 * ZERO_MODEL


@pytest.mark.parametrize(
    ("effect", "name", "error"),
    [("valve_edges", "excess_supply_1", MODEL_SHARE), ("valve_edges", "overlap_supply_1", 0.0), ("valve_offset", "shift", 0.0)],
)
def test_what_laws_get_wrong_of_a_flow_moves_areas_and_no_place_on_the_scale_of_the_command(effect: str, name: str, error: float) -> None:
    assert error_of_model(FreeParameter(effect, "piston", name, "1", Target.CYLINDER, 1e-3, -0.1, 0.1, (0.0, 1e-3)), 4.0) == error


def test_a_place_that_two_imperfections_stand_for_stays_with_one_of_them() -> None:
    """Machine m09 of the thirteenth stranger: each alone could go, both together left 11 times the noise instead of 3."""
    shift, overlap = (
        FreeParameter(effect, "piston", f"{effect}.level", "1", Target.SENSOR, 1e-3, -0.1, 0.1, (0.0, 1e-3))
        for effect in ("valve_offset", "valve_edges")
    )
    fits, model = fitted(waves.Waves(shapes={**waves.SHAPES, "level": np.full(400, 1e3)}, level=4e-4), shift, overlap)
    (gone,) = unneeded_of(fits, model)
    plain = without_unneeded(fits, model)
    assert gone in (shift, overlap) and plain.fit.values[shift] + plain.fit.values[overlap] == pytest.approx(4e-4, abs=1.5e-4)
