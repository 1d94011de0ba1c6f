"""What a curve over one signal does as well is no finding beside it; what it does not do stands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.selection.beside_curve import needed_beside_curve
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.model_fits import ModelFits

BOTH = (waves.BASE, waves.OTHER)


class Followed(waves.Waves):
    """Waves of which the slow one follows a signal: the curve over that cancels what is left of it."""

    def with_unknown(self, plant: PlantParameters, discrepancy: Discrepancy) -> PlantParameters:
        left, shape = self.residual_of(plant), waves.SHAPES["slow"]
        return replace(plant, sensors={**plant.sensors, "curve.slow": -float(left @ shape) / float(shape @ shape)})


class Unfollowed(Followed):
    """The same, where what is left follows no signal."""

    def main_discrepancy(self, plant: PlantParameters) -> Discrepancy:
        return replace(super().main_discrepancy(plant), curves=())


def judged(model: waves.Waves) -> tuple[FittedModel, tuple[Candidate, ...]]:
    fits = ModelFits(model, ())
    bare = fits.refined(fits.fit(()))
    return needed_beside_curve(model, model, lambda chosen: fits.fit(chosen, bare), fits.fit(BOTH, bare), BOTH)


def test_a_name_that_stands_for_what_follows_a_signal_is_not_needed() -> None:
    fitted, named = judged(Followed(1.5, slow=9.5, quicker=4.0, quick=3.0))
    assert named == fitted.candidates == (waves.OTHER,)


def test_names_that_no_curve_replaces_stand() -> None:
    for model in (waves.Waves(1.5, slow=9.5, quicker=4.0, quick=3.0), Unfollowed(1.5, slow=9.5, quicker=4.0, quick=3.0)):
        fitted, named = judged(model)
        assert named == fitted.candidates == BOTH


def test_where_nothing_is_needed_the_numbers_of_the_rig_are_left() -> None:
    fitted, named = judged(Followed(1.5, slow=9.5, quick=3.0))
    assert named == fitted.candidates == () and np.isfinite(fitted.fit.residual).all()
