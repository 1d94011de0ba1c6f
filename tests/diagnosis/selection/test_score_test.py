"""The score test promises what a fit then gains, where the model is linear."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.policy import signatures
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.score_test import Signatures, Sizes, scores, signature


@pytest.mark.parametrize("size", [0.5, 3.0, -3.0])
def test_a_linear_signature_promises_exactly_what_the_fit_gains(size: float) -> None:
    model = waves.Waves(slow=size)
    fits = ModelFits(model, (), cheap=True)
    now, then = fits.fit(()), fits.fit((waves.BASE,))
    ((promised, found),) = scores(model, now, (waves.BASE,))
    assert found is waves.BASE
    assert promised == pytest.approx(now.fit.sse - then.fit.sse, rel=1e-6)


def test_a_fit_may_begin_where_the_signature_leaves_least() -> None:
    """A wave that saturates far below its usual size: from there nothing leads back, along its signature it does."""

    class Saturating(waves.Waves):
        def residual_of(self, plant: PlantParameters) -> waves.Array:
            return self._error + self.shapes["slow"] * 30.0 * np.tanh(plant.sensors.get("base.slow", 0.0))

    model, fits = Saturating(slow=3.0), ModelFits(Saturating(slow=3.0), ())
    usual = replace(waves.BASE, starts=((20.0,),))
    (size,) = usual.parameters
    now = fits.fit(())
    assert np.sum(model.residual({size: 20.0}) ** 2) > now.fit.sse  # and a little less or more of it changes nothing
    assert [option[size] for option in fits._starts((usual,), now)[1]] == [20.0]
    scores(model, now, (usual,), signatures=Signatures(model, now, promised=fits.promised))
    (start,) = fits.promised[usual.key]
    assert 0.0 < start < 1.0
    assert [option[size] for option in fits._starts((usual,), now)[1]] == [20.0, start]
    found = fits.fit((usual,), now)
    assert found.fit.sse == pytest.approx(model.size, rel=0.1)


def test_what_a_fitted_parameter_explains_is_not_promised_again() -> None:
    model = waves.Waves(slow=3.0)
    now = ModelFits(model, (), cheap=True).fit((waves.BASE,))
    ((promised, _),) = scores(model, now, (waves.candidate("twin", "slow"),))
    assert promised == pytest.approx(0.0, abs=1e-6)


def test_an_effect_of_the_wrong_sign_promises_nothing() -> None:
    model = waves.Waves(slow=-3.0)
    one_sided = waves.candidate("leak", "slow")
    one_sided = replace(one_sided, parameters=(waves.parameter("leak", "slow", low=0.0),))
    assert [promised for promised, _ in scores(model, ModelFits(model, (), cheap=True).fit(()), (one_sided,))] == [0.0]


def test_candidates_in_the_model_and_those_without_prerequisite_are_left_out() -> None:
    model = waves.Waves(quick=5.0)
    fits = ModelFits(model, ())
    every = (waves.BASE, waves.ON_TOP, waves.OTHER)
    assert {c.effect for _, c in scores(model, fits.fit(()), every)} == {"base", "other"}
    assert [c.effect for _, c in scores(model, fits.fit((waves.BASE,)), every)] == ["on_top", "other"]


def test_signatures_of_a_neighbouring_model_serve_a_linear_one_and_are_predicted_once(monkeypatch: pytest.MonkeyPatch) -> None:
    model = waves.Waves(slow=3.0, quicker=-2.0)
    fits = ModelFits(model, (), cheap=True)
    bare, full = fits.fit(()), fits.fit((waves.BASE,))
    own = scores(model, bare, (waves.BASE, waves.OTHER))
    known = Signatures(model, full)
    assert [c.effect for _, c in own] == ["base", "other"]
    for _ in range(2):
        found = scores(model, bare, (waves.OTHER, waves.candidate("twin", "slow")), signatures=known)
        assert [promised for promised, _ in found] == pytest.approx([promised for promised, _ in own], rel=1e-6)
        monkeypatch.setattr(model, "residual", None)  # nothing more is predicted


@pytest.mark.parametrize(("begun", "level"), [(1.0, 1.0), (0.002, 1.0), (1.0, 0.01)], ids=["at once", "larger", "smaller"])
def test_a_signature_is_taken_where_it_shows_and_does_not_swamp(begun: float, level: float) -> None:
    model = waves.Waves(slow=3.0)
    now = ModelFits(model, (), cheap=True).fit(())
    sizes: Sizes = {}
    found = signature(model, waves.BASE, (begun,), now, [], now.fit.residual, level, sizes)
    assert found is not None
    change, values = found
    assert signatures.DROWNS * level <= np.sqrt(np.mean(change**2)) <= signatures.SWAMPS * level
    assert list(values.values()) == pytest.approx([begun * size for size in sizes.values()])
