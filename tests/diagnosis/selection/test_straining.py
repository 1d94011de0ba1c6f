"""An effect that only stands beside known numbers of its own family that are further off is left to what those get wrong."""

from __future__ import annotations

from dataclasses import replace

import pytest
from diagnosis import waves

from exo_sim.diagnosis.policy.off_nominal import STRAINING
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.straining import without_straining

FILM = waves.parameter("viscous_friction", "slow", prior=(0.0, 0.5))
SHAPES = {**waves.SHAPES, "bent": waves.SHAPES["quicker"] + 3.0 * waves.SHAPES["slow"]}


class Quiet(waves.Waves):
    """Seven tenths of the noise, and of what it is missed by."""

    def residual_of(self, plant: waves.PlantParameters) -> waves.Array:
        return 0.7 * super().residual_of(plant)


def named(effect: str, wave: str, bound: float, kind: type[waves.Waves] = waves.Waves, **sizes: float) -> list[str]:
    """Return what stands of an effect that adds a wave, where the rest of a machine gets waves of these sizes wrong."""
    fits = ModelFits(kind(bound, SHAPES, **sizes), (FILM,), cheap=True)
    plain = fits.refined(fits.fit((waves.candidate(effect, wave),)))
    return [c.effect for c in without_straining(plain, fits).candidates]


def test_what_bends_a_known_law_to_make_up_for_its_form_goes() -> None:
    assert named("quadratic_drag", "bent", 5.0, quicker=0.6) == []


def test_what_leaves_the_known_law_alone_stays() -> None:
    assert named("quadratic_drag", "quick", 5.0, quicker=0.6, quick=2.0) == ["quadratic_drag"]


@pytest.mark.parametrize(("effect", "bound"), [("return_spring", 5.0), ("quadratic_drag", 1.02)])
def test_another_family_or_more_than_a_healthy_machine_leaves_is_no_matter_of_the_known_law(effect: str, bound: float) -> None:
    assert named(effect, "bent", bound, quicker=0.6) == [effect]


def test_an_effect_whose_own_shape_is_unusual_strains_nothing_that_is_known() -> None:
    """Found friction that falls otherwise than most dips is far from the prior of its shape, and there all the same."""
    own = waves.parameter("stribeck_friction", "quick", prior=(0.0, 0.2))
    dip = replace(waves.candidate("stribeck_friction", "quick"), parameters=(own,))
    fits = ModelFits(waves.Waves(5.0, SHAPES, quick=1.2), (FILM,), cheap=True)
    plain = fits.refined(fits.fit((dip,)))
    assert plain.fit.penalty - fits.fit(()).fit.penalty > STRAINING
    assert without_straining(plain, fits) is plain


def test_of_what_the_noise_explains_nothing_stands_that_strains_any_number() -> None:
    assert named("return_spring", "bent", 1.0, Quiet, quicker=0.9) == []
