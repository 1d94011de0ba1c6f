"""Another name is as good where what distinguishes it would not show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.policy.verdicts import AS_GOOD
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.indistinguishable_effects import indistinguishable_effects
from exo_sim.diagnosis.selection.model_fits import ModelFits

GIVES = waves.candidate("transmission_compliance", "slow")
FREE = waves.parameter("sensor_zero", "level", prior=(0.0, 1.0))


def twins_of(twin: waves.Candidate, *found: waves.Candidate) -> list[tuple[str, float]]:
    fits = ModelFits(waves.Waves(slow=3.0), (FREE,), cheap=True)
    final = fits.refined(fits.fit(found))
    pairs = indistinguishable_effects(fits.model, final, (GIVES, twin, waves.OTHER)).get(GIVES.key, [])
    return [(one.effect, lost) for one, lost in pairs]


def test_what_the_finding_itself_or_a_nuisance_parameter_makes_up_for_does_not_show() -> None:
    assert twins_of(waves.candidate("backlash", "slow"), GIVES) == [("backlash", pytest.approx(0.0, abs=0.1))]
    ((name, lost),) = twins_of(waves.candidate("backlash", "level"), GIVES)
    assert name == "backlash" and lost < AS_GOOD


def test_what_nothing_makes_up_for_shows_and_the_name_stands_alone() -> None:
    assert twins_of(waves.candidate("backlash", "quick"), GIVES) == []


def test_only_a_declared_twin_at_the_same_place_that_was_not_found_itself_is_asked() -> None:
    assert twins_of(waves.candidate("piston_leakage", "slow"), GIVES) == []
    play = waves.candidate("backlash", "quick")
    assert twins_of(play, GIVES, play) == []
    assert twins_of(waves.candidate("backlash", "slow")) == []


def test_what_gives_as_a_strap_does_is_no_contact() -> None:
    stiffness = FreeParameter("transmission_compliance", "piston", "stiffness", "N/m", Target.SENSOR, 1e4, 0.0, 1e8)
    mount = Candidate("transmission_compliance", "piston", "stiffness", (stiffness,), ((1e5,),))
    play = waves.candidate("backlash", "slow")
    model = waves.Waves(shapes={**waves.SHAPES, "stiffness": np.zeros(waves.AT.size)})
    fits = ModelFits(model, (waves.parameter("sensor_zero", "slow", prior=(0.0, 1.0)),), cheap=True)
    bare = fits.refined(fits.fit(()))

    def twins(value: float) -> int:
        fit = replace(bare.fit, values={**bare.fit.values, stiffness: value})
        return len(indistinguishable_effects(fits.model, FittedModel((mount,), fit), (play,)))

    assert (twins(2e4), twins(6e5)) == (0, 1)


@pytest.mark.parametrize("alike", [True, False], ids=["the same to the data", "seen to differ"])
def test_what_a_finding_is_in_parts_is_as_good_a_name_where_the_data_do_not_tell(alike: bool) -> None:
    names = ("overlap_supply_1", "overlap_exhaust_1", "overlap_supply_2", "overlap_exhaust_2")
    slow = waves.SHAPES["slow"]
    by_name = {"shift": slow, **dict(zip(names, (-slow, 0.0 * slow, 0.0 * slow, 0.0 * slow), strict=True))}
    if not alike:
        by_name["overlap_exhaust_1"] = waves.SHAPES["quick"]

    def number(effect: str, name: str, prior: tuple[float, float] | None = None) -> FreeParameter:
        return FreeParameter(effect, "piston", name, "1", Target.SENSOR, 1.0, -10.0, 10.0, prior)

    shift = number("valve_offset", "shift")
    offset = Candidate("valve_offset", "piston", "shift", (shift,), ((1.0,),))
    edges = Candidate("valve_edges", "piston", "laps", tuple(number("valve_edges", name) for name in names), ((0.0,) * 4,))
    healthy = number("valve_edges", names[1], (0.0, 0.002))
    fits = ModelFits(waves.Waves(shapes=by_name, shift=3.0), (healthy,), cheap=True)
    final = fits.refined(fits.fit((offset,)))
    found = indistinguishable_effects(fits.model, final, (edges,))
    if not alike:
        assert found == {}
        return
    ((twin, lost),) = found[offset.key]
    size = final.fit.values[shift]
    assert twin.at == edges.at and lost < AS_GOOD
    assert twin.starts[0] == pytest.approx((-size, size, size, -size), abs=0.02)
    on_top = replace(edges, prerequisite="valve_deadband")
    assert indistinguishable_effects(fits.model, final, (on_top,)) == {}
