"""The measured supply of a machine as a least-squares problem: whitened errors of its pressure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.computed_columns import shown_noise
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.discrepancy.trace import Trace
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.findings import Finding, Series, Subsystem
from exo_sim.diagnosis.policy import healthy, significance
from exo_sim.diagnosis.policy.regimes import DRAWING
from exo_sim.diagnosis.subsystem_model import Comparison, SubsystemModel
from exo_sim.diagnosis.subsystems.supply.prediction import follow_supply
from exo_sim.physics.declaration import identification_of

Array = NDArray[np.float64]

#: Errors are averaged over this time before they are compared [s].
GROUP = 0.01
#: Length of a block of time [s].
BLOCK = 1.0

@dataclass(frozen=True)
class SupplyRun:
    """The supply in one recording: measured pressure [Pa] and flow drawn from it [kg/s], shape (n,) each; noise of the former [Pa].

    `computed` says whether the recording was computed and not measured.
    """

    recording: str
    time: Array
    pressure: Array
    drawn: Array
    noise: float
    computed: bool = False


class SupplyModel(SubsystemModel):
    """The supply of a machine, any number of recordings.

    Args:
        runs: Pressure and drawn flow.
        nominal: The nominal machine.
        split: Which time may be used.
        on_test: Whether the rows are those of the test time.
    """

    kind = Subsystem.SUPPLY
    is_input_of_others = True
    balance = "mass balance"
    unit = "Pa"
    where = "supply"

    def __init__(self, runs: Sequence[SupplyRun], nominal: PlantParameters, split: Split, on_test: bool = False):
        self.runs, self.nominal = tuple(runs), nominal
        self._groups: list[NDArray[np.int64]] = []
        blocks, scales, offset = [], [], 0
        for run in self.runs:
            chosen = (split.in_test if on_test else split.in_training)(run.recording, run.time)
            bins = np.floor((run.time - run.time[0]) / GROUP).astype(np.int64)
            good = chosen & np.isfinite(run.pressure)
            used, group = np.unique(bins[good], return_inverse=True)
            whole = np.full(len(run.time), -1)
            whole[good] = group
            self._groups.append(whole)
            blocks.append((used * GROUP / BLOCK).astype(np.int64) + offset)
            offset += int(blocks[-1].max()) + 1 if used.size else 0
            count = np.bincount(group, minlength=used.size)
            floor = healthy.SUPPLY_FLOOR_SHARE * float(np.nanmean(run.pressure))
            scales.append(np.sqrt(run.noise**2 / np.maximum(count, 1) + floor**2))
        self.blocks = np.concatenate(blocks) if blocks else np.zeros(0, np.int64)
        self.scale = np.concatenate(scales) if scales else np.zeros(0)

    @property
    def practical_significance(self) -> float:
        level = max((float(np.nanmean(run.pressure)) for run in self.runs), default=0.0)
        return significance.SUPPLY_SIGNIFICANT * level / float(np.median(self.scale)) if self.scale.size else 0.0

    @property
    def discrepancy_bound(self) -> float:
        return healthy.SUPPLY_BOUND * self.practical_significance

    def predict(self, plant: PlantParameters, index: int) -> Array:
        """Return the predicted supply pressure of one run [Pa], shape (n,)."""
        run = self.runs[index]
        out = np.empty(len(run.time))
        follow_supply(plant.world, run.time, run.drawn, plant.sensors.get("supply_pressure", 0.0), out)
        return out

    def residual_of(self, plant: PlantParameters) -> Array:
        pieces = []
        for index, (run, group) in enumerate(zip(self.runs, self._groups, strict=True)):
            keep = group >= 0
            error = (run.pressure - self.predict(plant, index))[keep]
            pieces.append(np.bincount(group[keep], weights=error) / np.maximum(np.bincount(group[keep]), 1))
        return np.concatenate(pieces) / self.scale if pieces else np.zeros(0)

    def on_test_time(self, split: Split) -> SupplyModel:
        return SupplyModel(self.runs, self.nominal, split, on_test=True)

    def compared(self, before: PlantParameters, after: PlantParameters, curve: Curve | None = None) -> list[Comparison]:
        found = []
        for index, (run, group) in enumerate(zip(self.runs, self._groups, strict=True)):
            first, second = self.predict(before, index), self.predict(after, index)
            noise = shown_noise(run.noise, run.pressure, run.computed)
            series = Series(run.recording, "supply.pressure", self.unit, run.time, run.pressure, first, second, noise)
            found.append(Comparison(series, (run.pressure - first)[group >= 0], (run.pressure - second)[group >= 0]))
        return found

    def traces(self, plant: PlantParameters) -> list[Trace]:
        found = []
        for index, (run, group) in enumerate(zip(self.runs, self._groups, strict=True)):
            error = np.where(group >= 0, run.pressure - self.predict(plant, index), np.nan)
            noise = float(np.median(self.scale)) if self.scale.size else 1.0
            little = DRAWING * float(run.drawn.max())
            regimes = {"drawing": run.drawn > little, "resting": run.drawn <= little}
            found.append(Trace(self.where, self.balance, self.unit, run.recording, run.time, error, noise, regimes))
        return found

    def discrepancies(self, plant: PlantParameters) -> tuple[Discrepancy, ...]:
        size = float(np.std(self.residual_of(plant) * self.scale))
        return (Discrepancy("flow", self.unit, self.balance, (), size),)

    def column(self, variable: str) -> str:
        return variable if variable == "time" else f"{self.where}.{variable}"

    def indistinguishable(self, findings: Sequence[Finding], fit: Fit) -> Mapping[tuple[str, str], tuple[str, ...]]:
        """Declared twins, unless what only one of them has was fitted."""
        twins = {f.at: identification_of(f.name).twins.like(f.numbers, True) for f in findings}
        return {key: names for key, names in twins.items() if names}
