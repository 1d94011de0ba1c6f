"""What identifies a result, when it is empty, and the plant that its final model has."""

from __future__ import annotations

import numpy as np
from diagnosis import waves

from exo_sim.diagnosis.findings import Subsystem
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult


def test_a_fitted_wave_is_in_its_final_plant_and_cancels_there() -> None:
    model = waves.Waves(slow=3.0)
    fits = ModelFits(model, ())
    final = fits.fit((waves.BASE,))
    one = SubsystemResult("piston", model, fits, SearchResult(fits.fit(()), final), final)
    assert one.key == (Subsystem.GAS, "piston") and one.where == "piston" and not one.is_empty
    (size,) = waves.BASE.parameters
    assert one.final_plant.sensors == {size.parameter: final.fit.values[size]}
    assert np.std(model.residual_of(one.final_plant)) < np.std(model.residual_of(model.nominal))
    assert one.plant_of(one.search.baseline).sensors == {}


def test_a_result_without_rows_is_empty() -> None:
    model = waves.Waves()
    model.blocks = np.zeros(0, np.int64)
    final = FittedModel((), ModelFits(waves.Waves(), ()).fit(()).fit)
    assert SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final).is_empty
