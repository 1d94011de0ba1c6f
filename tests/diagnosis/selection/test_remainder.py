"""When what a model leaves is unknown: each condition on its own, and which of them is asked first."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.nominal_numbers import FORCE_OFFSET
from exo_sim.diagnosis.selection.fitted_model import SearchResult, Unnamed
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.remainder import Remainder, has_bursts
from exo_sim.physics.plant_records import CYLINDER, WORLD

OFFSET = waves.parameter(FORCE_OFFSET, "level", prior=(0.0, 0.1))
GAIN = waves.parameter("gain", "level", prior=(0.0, 0.1))


def remainder(model: waves.Waves, *named: waves.Candidate, nuisances: tuple[Any, ...] = (), **search: Any) -> Remainder:
    """Return what these candidates leave."""
    fits = ModelFits(model, nuisances)
    bare = fits.refined(fits.fit(()))
    final = fits.refined(fits.fit(named, bare)) if named else bare
    return Remainder(model, fits, SearchResult(bare, final, **search), final, named)


class Bursting(waves.Waves):
    """Waves whose errors come in bursts."""

    def has_bursts(self, plant: PlantParameters) -> bool:
        return True


def test_noise_and_what_a_healthy_machine_leaves_is_not_unknown() -> None:
    assert not remainder(waves.Waves(1e-3)).is_unknown
    assert not remainder(waves.Waves(10.0, slow=9.0)).is_unknown
    assert remainder(waves.Waves(1.5, slow=9.0)).is_unknown


def test_a_curve_that_was_found_and_bursts_that_no_name_explains_are_unknown_however_little_is_left() -> None:
    assert remainder(waves.Waves(), unnamed=(Unnamed("position", 0.9, 0.2),)).is_unknown
    bursting = remainder(Bursting())
    assert bursting.is_unknown and has_bursts(bursting.model, bursting.final)


def test_beside_a_hose_that_the_rig_has_bursts_are_what_its_law_leaves_out() -> None:
    model = Bursting()
    model.nominal = PlantParameters(np.zeros(1, WORLD), np.zeros(1, CYLINDER))
    model.nominal.cylinder["valve_lag"]["time_constant"] = 5e-3
    assert remainder(model).is_unknown
    model.nominal.cylinder["line_restriction"]["area"] = 1e-5
    assert not remainder(model).is_unknown


def test_without_a_name_little_that_is_correlated_is_noise() -> None:
    assert not remainder(waves.Waves(1.5, slow=2.0)).is_unknown
    assert remainder(waves.Waves(1.5, slow=4.0)).is_unknown


def test_names_that_explain_nearly_everything_stand() -> None:
    assert not remainder(waves.Waves(1.5, slow=9.0, quick=2.0), waves.BASE).is_unknown
    assert remainder(waves.Waves(1.5, slow=9.0, quick=5.0), waves.BASE).is_unknown


def test_of_names_that_were_weighed_together_more_is_borne_until_it_is_plainly_too_much() -> None:
    class Patternless(waves.Waves):
        def discrepancies(self, plant: PlantParameters) -> tuple[Discrepancy, ...]:
            return ()

    def unknown(bound: float, kind: type[waves.Waves] = Patternless) -> bool:
        return remainder(kind(bound, slow=9.0, quick=5.0), waves.BASE, weighed_together=True).is_unknown

    assert unknown(1.2) and not unknown(1.5)
    assert unknown(1.5, waves.Waves)  # it follows a signal


@pytest.mark.parametrize(("nuisance", "unknown"), [(GAIN, True), (OFFSET, False)])
def test_a_strained_number_speaks_for_something_missing_and_the_zero_of_a_force_does_not(nuisance: Any, unknown: bool) -> None:
    model = waves.Waves(1.5, slow=9.9, quick=3.0, level=5.0)
    one = remainder(model, waves.BASE, nuisances=(nuisance,))
    values = {**one.final.fit.values, nuisance: 5.0}
    final = replace(one.final, fit=replace(one.final.fit, values=values, residual=model.residual(values)))
    assert replace(one, final=final).is_unknown is unknown
