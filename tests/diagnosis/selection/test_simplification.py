"""Simplification: what is not worth its parameters goes, and with it what stands on it."""

from __future__ import annotations

from diagnosis.waves import BASE, ON_TOP, OTHER, Waves

from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.search import Search
from exo_sim.diagnosis.selection.simplification import Simplification


def test_pruning_keeps_what_another_stands_on() -> None:
    one = Search(Waves(quick=5.0), (), (BASE, ON_TOP, OTHER))
    comparisons = Comparisons(one.fits, one.fits.fit(()), 3, 0.0)
    simplification = Simplification(one.fits, comparisons, one.proposals)
    kept = simplification.pruned(one.fits.fit((BASE, ON_TOP)))
    assert {c.effect for c in kept.candidates} == {"base", "on_top"}
    assert simplification.pruned(one.fits.fit((BASE, OTHER))).candidates == ()
