"""Directions of a joint proposal: one for each size of an effect, or for each of its amounts, as far as they can be predicted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.threads import SERIAL
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.selection.directions import FURTHEST, LEAST, Direction, directions
from exo_sim.diagnosis.selection.model_fits import ModelFits

MODEL = waves.Waves(slow=2.0, quick=-2.0)


def of(*candidates: Candidate) -> list[Direction]:
    return directions(MODEL, ModelFits(MODEL, ()).fit(()), candidates, SERIAL, lambda: False, {})


def test_a_direction_is_the_change_of_the_residual_by_its_size() -> None:
    (direction,) = of(waves.BASE)
    (parameter,) = waves.BASE.parameters
    full, nil = direction.sizes[parameter]
    bare, there = (MODEL.residual({parameter: value}) for value in (nil, full))
    np.testing.assert_allclose(direction.columns[:, 0], there - bare, atol=1e-12)


def test_every_start_of_an_effect_is_a_direction_of_its_own() -> None:
    assert len(of(replace(waves.BASE, starts=((1.0,), (3.0,))))) == 2


def test_amounts_that_are_nil_where_the_effect_is_absent_count_apart() -> None:
    both = waves.candidate("both", "slow", "quick")
    both = replace(both, parameters=tuple(replace(q, low=0.0, logarithmic=False) for q in both.parameters))
    (direction,) = of(both)
    assert direction.columns.shape == (MODEL.size, 2) and direction.one_sided


def test_faults_of_sensors_what_the_model_has_and_what_changes_nothing_have_no_direction() -> None:
    assert of(replace(waves.BASE, kind=Kind.SENSOR)) == []
    assert directions(MODEL, ModelFits(MODEL, ()).fit((waves.BASE,)), [waves.BASE], SERIAL, lambda: False, {}) == []
    idle = waves.Waves(shapes={**waves.SHAPES, "slow": 0.0 * waves.SHAPES["slow"]})
    assert directions(idle, ModelFits(idle, ()).fit(()), [waves.BASE], SERIAL, lambda: False, {}) == []


def test_where_the_time_is_up_nothing_more_is_predicted() -> None:
    assert directions(MODEL, ModelFits(MODEL, ()).fit(()), [waves.BASE], SERIAL, lambda: True, {}) == []


@pytest.mark.parametrize(("amplitude", "begun"), [(0.5, 0.5), (100.0, FURTHEST), (0.01, LEAST), (-1.0, LEAST)])
def test_a_fit_begins_neither_at_nil_nor_far_beyond_what_was_tried(amplitude: float, begun: float) -> None:
    (parameter,) = waves.BASE.parameters
    parameter = replace(parameter, low=0.0, high=100.0, neutral=0.0)
    direction = Direction(replace(waves.BASE, proportional=True), {parameter: (2.0, 0.0)}, np.ones((3, 1)), one_sided=True)
    assert direction.values(np.array([amplitude])) == {parameter: pytest.approx(2.0 * begun)}
