"""Candidates: what comes on top of another goes with it."""

from __future__ import annotations

from diagnosis import waves

from exo_sim.diagnosis.estimation.candidate import drop_orphans


def test_what_lacks_its_prerequisite_is_dropped_and_so_is_what_stood_on_it() -> None:
    third = waves.candidate("third", "level", prerequisite="on_top")
    assert drop_orphans((waves.BASE, waves.ON_TOP, third)) == (waves.BASE, waves.ON_TOP, third)
    assert drop_orphans((waves.ON_TOP, third, waves.OTHER)) == (waves.OTHER,)
    assert drop_orphans(()) == ()


def test_the_richer_form_of_a_prerequisite_bears_what_comes_on_top_of_it() -> None:
    dip = waves.candidate("stribeck_friction", "quick", prerequisite="coulomb_friction")
    seal = waves.candidate("asymmetric_friction", "slow")
    assert seal.bears == {"asymmetric_friction", "coulomb_friction"} and dip.bears == {"stribeck_friction"}
    assert drop_orphans((seal, dip)) == (seal, dip) and drop_orphans((dip,)) == ()


def test_forms_of_one_effect_are_the_same_effect() -> None:
    one, other = waves.candidate("lag", "slow"), waves.candidate("lag", "slow", "quick")
    assert one.at == other.at and one.key != other.key and one.label == "lag@piston[slow]"
