"""Candidates: what comes on top of another goes with it."""

from __future__ import annotations

from diagnosis import waves

from exo_sim.diagnosis.estimation.candidate import drop_orphans


def test_what_lacks_its_prerequisite_is_dropped_and_so_is_what_stood_on_it() -> None:
    third = waves.candidate("third", "level", prerequisite="on_top")
    assert drop_orphans((waves.BASE, waves.ON_TOP, third)) == (waves.BASE, waves.ON_TOP, third)
    assert drop_orphans((waves.ON_TOP, third, waves.OTHER)) == (waves.OTHER,)
    assert drop_orphans(()) == ()


def test_forms_of_one_effect_are_the_same_effect() -> None:
    one, other = waves.candidate("lag", "slow"), waves.candidate("lag", "slow", "quick")
    assert one.at == other.at and one.key != other.key and one.label == "lag@piston[slow]"
