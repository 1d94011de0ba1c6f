"""A model without one of its effects: gone where a healthy machine has none, else held to what that has."""

from __future__ import annotations

from diagnosis import waves

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.selection.left_out import left_out
from exo_sim.diagnosis.selection.model_fits import ModelFits


def part(name: str, most: float, healthy: float = 0.0) -> FreeParameter:
    prior = None if healthy else (0.0, 1.0)
    return FreeParameter("late", "piston", f"late.{name}", "1", Target.SENSOR, 1.0, -most, most, prior, healthy_limit=healthy)


def test_what_no_healthy_machine_has_is_gone() -> None:
    model = waves.Waves(slow=3.0)
    fits = ModelFits(model, (), cheap=True)
    whole = fits.fit((waves.BASE,))
    without, is_gone = left_out(waves.BASE, whole, fits)
    assert is_gone and without.candidates == () and without.fit.sse > whole.fit.sse


def test_parts_that_healthy_machines_may_each_have_do_not_stand_in_for_it() -> None:
    """Of 6, parts of up to 1 each would make up 2; a healthy machine has 1 of both together."""
    model = waves.Waves(shapes={**waves.SHAPES, "again": waves.SHAPES["slow"]}, slow=6.0)
    fits = ModelFits(model, (part("slow", 1.0), part("again", 1.0)), cheap=True)
    asked = Candidate("late", "piston", "slow", (part("slow", 10.0, healthy=1.0),), ((1.0,),), additive=True)
    without, is_gone = left_out(asked, fits.fit((asked,)), fits)
    assert not is_gone and without.candidates == ()
    assert abs(sum(without.fit.values.values())) <= 1.0 + 1e-9
    freely = fits.fit(())
    assert without.fit.sse > 1.3 * freely.fit.sse
