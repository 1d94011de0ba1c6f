"""A subsystem of noise and waves, linear in its parameters: whatever is asked of it has a known answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.discrepancy.trace import Trace
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.linear_family import Term
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.findings import Series, Subsystem
from exo_sim.diagnosis.subsystem_model import Comparison, SubsystemModel

Array = NDArray[np.float64]

AT = np.arange(400.0)
SHAPES: Mapping[str, Array] = {"slow": np.sin(AT / 30.0), "quick": np.sin(AT / 11.0), "quicker": np.cos(AT / 5.0), "level": np.ones(400)}
PARTS = Split({})


def parameter(effect: str, wave: str, prior: tuple[float, float] | None = None, low: float = -10.0) -> FreeParameter:
    """Return the size of a wave, as a parameter of an effect."""
    return FreeParameter(effect, "piston", f"{effect}.{wave}", "1", Target.SENSOR, 1.0, low, 10.0, prior)


def candidate(effect: str, *waves: str, prerequisite: str = "") -> Candidate:
    """Return an effect that adds these waves."""
    parameters = tuple(parameter(effect, wave) for wave in waves)
    return Candidate(effect, "piston", "+".join(waves), parameters, ((1.0,) * len(waves),), prerequisite=prerequisite)


BASE, ON_TOP, OTHER = candidate("base", "slow"), candidate("on_top", "quick", prerequisite="base"), candidate("other", "quicker")


class Waves(SubsystemModel):
    """White noise of size 1 and waves of the given sizes, which a parameter of the same size cancels.

    Args:
        bound: Discrepancy bound.
        sizes: Of the waves.
    """

    kind = Subsystem.GAS
    balance = "sum of waves"
    unit = "Pa"
    where = "piston"

    def __init__(self, bound: float = 1e9, shapes: Mapping[str, Array] = SHAPES, **sizes: float):
        self.nominal = PlantParameters(np.zeros(1, np.void), np.zeros(1, np.void))
        self.blocks = (AT // 40).astype(np.int64)
        self.bound, self.shapes = bound, shapes
        self._error: Array = np.random.default_rng(8).standard_normal(AT.size) - sum(size * shapes[name] for name, size in sizes.items())

    @property
    def practical_significance(self) -> float:
        return 0.0

    @property
    def discrepancy_bound(self) -> float:
        return self.bound

    def residual_of(self, plant: PlantParameters) -> Array:
        waves = (value * self.shapes[name.split(".")[-1]] for name, value in plant.sensors.items())
        return self._error + sum(waves, np.zeros(AT.size))

    def traces(self, plant: PlantParameters) -> list[Trace]:
        rising = np.gradient(self.shapes["slow"]) > 0.0
        return [Trace(self.where, self.balance, self.unit, "recording", AT, self.residual_of(plant), 1.0, {"rising": rising})]

    def discrepancies(self, plant: PlantParameters) -> tuple[Discrepancy, ...]:
        at = np.array([-1.0, 1.0])
        left = float(np.std(self.residual_of(plant)))
        return (Discrepancy("flow_1", "kg/s", self.balance, (Curve("position", at, at, 0.1 * np.abs(at), 0.9),), left),)

    def column(self, variable: str) -> str:
        return f"slide.{variable}"

    def on_test_time(self, split: Split) -> Waves:
        return self

    def compared(self, before: PlantParameters, after: PlantParameters, curve: Curve | None = None) -> list[Comparison]:
        first, second = self.residual_of(before), self.residual_of(after)
        series = Series("recording", "piston.pressure_1", self.unit, AT, np.zeros(AT.size), -first, -second, 1.0)
        return [Comparison(series, first, second)]


def term(model: Waves, candidate: Candidate, group: str = "", one_sided: bool = False) -> Term:
    """Return an effect's waves as a term of a linear family: what a size of it cancels."""
    columns = [model.shapes[q.parameter.split(".")[-1]] for q in candidate.parameters]

    def parameters(sizes: Array, before: Mapping[FreeParameter, float]) -> dict[FreeParameter, float]:
        return dict(zip(candidate.parameters, map(float, sizes), strict=True))

    spread = np.full(len(columns), 4.0)
    return Term(candidate, np.column_stack(columns), spread, (one_sided,) * len(columns), parameters, group or candidate.effect)


SIZE, RATE = replace(parameter("line_restriction", "size"), low=0.0), replace(parameter("line_restriction", "rate"), low=1.0, high=60.0)
#: What rings at a rate that no fit finds from a quarter of it away, but a grid does.
RINGS = Candidate(
    "line_restriction", "piston", "size+rate", (SIZE, RATE), ((2.0, 6.0),), proportional=False,
    shapes=tuple((size, rate) for size in (2.0, 6.0) for rate in np.arange(5.0, 60.0, 0.5)),
)  # fmt: skip


class Ringing(Waves):
    """Waves, and a slow one of a size of its own with which something rings.

    Args:
        size: Of that.
        rate: How often it rings.
        sizes: Of the other waves.
    """

    def __init__(self, size: float, rate: float, **sizes: float):
        super().__init__(1e9, SHAPES, **sizes)
        self._error = self._error - self._rings(size, rate)

    def _rings(self, size: float, rate: float) -> Array:
        return size * (self.shapes["slow"] + 0.3 * np.sin(2.0 * np.pi * rate * AT / AT.size))

    def residual_of(self, plant: PlantParameters) -> Array:
        plain = {name: value for name, value in plant.sensors.items() if name not in (SIZE.parameter, RATE.parameter)}
        own = self._rings(plant.sensors.get(SIZE.parameter, 0.0), plant.sensors.get(RATE.parameter, 1.0))
        return super().residual_of(replace(plant, sensors=plain)) + own
