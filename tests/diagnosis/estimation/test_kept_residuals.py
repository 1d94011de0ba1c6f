"""What was predicted of a plant is predicted once, while it is kept."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.diagnosis.estimation import kept_residuals
from exo_sim.diagnosis.estimation.kept_residuals import KeptResiduals
from exo_sim.diagnosis.estimation.parameters import PlantParameters

SENSORS = np.dtype([("a", float)])


def plant(world: float = 0.0, cylinder: float = 0.0, **sensors: float) -> PlantParameters:
    return PlantParameters(np.array([(world,)], SENSORS), np.array([(cylinder,)], SENSORS), dict(sensors))


class Predicted:
    """Counts what is predicted."""

    def __init__(self) -> None:
        self.calls = 0

    def __call__(self, one: PlantParameters) -> np.ndarray:
        self.calls += 1
        return np.full(100, float(self.calls))


def test_the_same_plant_is_predicted_once_whatever_the_order_of_its_sensors() -> None:
    predicted = Predicted()
    kept = KeptResiduals()
    first = kept.of(plant(1.0, 2.0, bias=3.0, scale=4.0), predicted)
    assert kept.of(plant(1.0, 2.0, scale=4.0, bias=3.0), predicted) is first and predicted.calls == 1
    for other in (plant(1.5, 2.0, bias=3.0, scale=4.0), plant(1.0, 2.5, bias=3.0, scale=4.0), plant(1.0, 2.0, bias=3.5, scale=4.0)):
        assert kept.of(other, predicted) is not first
    assert predicted.calls == 4


def test_nobody_may_write_to_what_is_kept() -> None:
    with pytest.raises(ValueError, match="read-only"):
        KeptResiduals().of(plant(), Predicted())[0] = 1.0


def test_what_was_not_asked_for_longest_goes_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept_residuals, "MOST_BYTES", 2 * 800)
    predicted = Predicted()
    kept = KeptResiduals()
    one, two, three = plant(1.0), plant(2.0), plant(3.0)
    for each in (one, two, one, three, one):
        kept.of(each, predicted)
    assert predicted.calls == 3
    kept.of(two, predicted)
    assert predicted.calls == 4
