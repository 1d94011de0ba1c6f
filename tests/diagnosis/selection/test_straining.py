"""An effect that only stands beside known numbers of its own family that are further off is left to what those get wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.nominal_numbers import FORCE_OFFSET
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


def friction(effect: str, *numbers: str) -> Candidate:
    parameters = tuple(replace(waves.parameter(effect, "", low=0.0), parameter=name) for name in numbers)
    return Candidate(effect, "piston", "+".join(numbers), parameters, ((1.0,) * len(numbers),))


@pytest.mark.parametrize(
    ("backward", "left"), [(9.0, "coulomb_friction"), (14.0, "asymmetric_friction")], ids=["of one", "of two directions"]
)
def test_two_directions_against_which_a_force_stands_that_no_sensor_makes_are_one(backward: float, left: str) -> None:
    """Cantera's second of seed 2811282: 22 and 35 N beside 6 N that sensors of 1 N made, of friction that is 28.6 N both ways."""
    outward = np.sin(waves.AT / 7.0) > 0.0
    shapes = {
        **SHAPES, "forward": 1.0 * outward, "backward": -1.0 * ~outward, "force": np.where(outward, 1.0, -1.0),
        "pulled": 1.0 + 0.3 * waves.SHAPES["quicker"],
    }  # fmt: skip
    constant = waves.parameter(FORCE_OFFSET, "pulled", prior=(0.0, 0.5))
    fits = ModelFits(waves.Waves(5.0, shapes, forward=9.0, backward=backward, quicker=0.6), (constant,), cheap=True)
    apart, plain = friction("asymmetric_friction", "forward", "backward"), friction("coulomb_friction", "force")
    found = fits.refined(fits.fit((apart,)))
    assert found.fit.penalty > STRAINING
    assert [c.effect for c in without_straining(found, fits, {plain.effect: plain}).candidates] == [left]
