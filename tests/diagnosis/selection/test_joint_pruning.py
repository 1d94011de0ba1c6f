"""What is not missed beside the others goes, and what is missed stays."""

from __future__ import annotations

from diagnosis import waves

from exo_sim.diagnosis.selection.joint_pruning import jointly_pruned
from exo_sim.diagnosis.selection.model_fits import ModelFits

LEVEL = waves.candidate("level", "level")


def test_false_effects_go_and_true_ones_stay() -> None:
    model = waves.Waves(slow=3.0, quicker=-2.0)
    now = ModelFits(model, ()).fit((waves.BASE, waves.OTHER, LEVEL))
    assert {c.effect for c in jointly_pruned(model, now)} == {"base", "other"}


def test_of_two_that_are_the_same_one_stays() -> None:
    model = waves.Waves(slow=3.0)
    now = ModelFits(model, ()).fit((waves.BASE, waves.candidate("twin", "slow")))
    assert len(jointly_pruned(model, now)) == 1


def test_what_comes_on_top_goes_with_what_it_is_on() -> None:
    model = waves.Waves()
    now = ModelFits(model, ()).fit((waves.BASE, waves.ON_TOP))
    assert jointly_pruned(model, now) == ()


def test_nothing_is_pruned_from_nothing() -> None:
    model = waves.Waves(slow=3.0)
    assert jointly_pruned(model, ModelFits(model, ()).fit(())) == ()
