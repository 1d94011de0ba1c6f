"""The shape that leaves least with all else refitted is where a fit arrives from; the error where it begins does not tell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.shape_scan import best_shape

TIME = np.linspace(0.0, 1.0, 400)
LEVEL = FreeParameter("level", "part", "level", "1", Target.CYLINDER, 1.0, -50.0, 50.0)
VOLUME = FreeParameter("dead_volume", "part", "dead", "1", Target.FACTOR, 0.1, 0.05, 10.0, (1.0, 0.15), neutral=1.0)
SIZE = FreeParameter("line_restriction", "part", "size", "1", Target.CYLINDER, 1.0, 0.0, 50.0, displaces=((VOLUME.key, 0.1),))
RATE = FreeParameter("line_restriction", "part", "rate", "1", Target.CYLINDER, 1.0, 1.0, 60.0)
GRID = tuple((size, rate) for size in (2.0, 6.0) for rate in np.arange(5.0, 60.0, 0.5))
RINGS = Candidate("line_restriction", "part", "size+rate", (SIZE, RATE), ((2.0, 6.0),), shapes=GRID, proportional=False)


class Ringing:
    """A level, a dead volume that tilts, and what rings at a rate."""

    discrepancy_bound = 1.0

    def __init__(self, size: float, rate: float, dead: float):
        self.truth = {LEVEL: 3.0, VOLUME: dead, SIZE: size, RATE: rate}
        self.blocks = np.zeros(TIME.size, dtype=np.int64)
        self.size = TIME.size
        self.noise = 0.1 * np.random.default_rng(5).standard_normal(TIME.size)

    def signal(self, values: dict[FreeParameter, float]) -> np.ndarray:
        size, rate = values.get(SIZE, 0.0), values.get(RATE, 1.0)
        tilt = 40.0 * (values[VOLUME] + 0.1 * size) * TIME
        return np.asarray(values[LEVEL] + tilt + size * np.sin(rate * TIME * 2.0 * np.pi))

    def residual(self, values: dict[FreeParameter, float], fixed: object = ()) -> np.ndarray:
        return self.signal(values) - self.signal(self.truth) + self.noise


def beside_nothing(model: Ringing) -> tuple[ModelFits, FittedModel]:
    fits = ModelFits(model, (LEVEL, VOLUME))
    return fits, fits.refined(fits.fit(()))


@pytest.mark.parametrize(("size", "rate"), [(6.0, 20.4), (2.5, 41.0)])
def test_a_fit_arrives_from_the_best_shape_and_not_from_the_start_that_leaves_least(size: float, rate: float) -> None:
    model = Ringing(size, rate, dead=1.0 - 0.1 * size)
    fits, now = beside_nothing(model)
    found = best_shape(model, now, RINGS)
    assert found is not None
    drop, begun = found
    assert drop > 0.2 * now.fit.sse
    assert abs(begun.fit.values[RATE] - rate) <= 0.5
    assert begun.fit.values[VOLUME] < now.fit.values[VOLUME]  # it was counted in
    arrived = fits.refined(fits.fit((RINGS,), begun))
    assert arrived.fit.values[RATE] == pytest.approx(rate, abs=0.05) and arrived.fit.values[SIZE] == pytest.approx(size, rel=0.05)
    elsewhere = ModelFits(model, (LEVEL, VOLUME)).fit((replace(RINGS, shapes=()),), now)
    assert elsewhere.fit.sse > 10.0 * arrived.fit.sse


def test_where_nothing_rings_no_shape_promises_much() -> None:
    model = Ringing(0.0, 20.0, dead=0.9)
    _, now = beside_nothing(model)
    assert best_shape(model, now, RINGS) is None


def test_when_the_time_is_up_nothing_is_looked_at() -> None:
    model = Ringing(6.0, 20.4, dead=0.4)
    _, now = beside_nothing(model)
    assert best_shape(model, now, RINGS, is_spent=lambda: True) is None
