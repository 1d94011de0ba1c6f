"""The gas of one cylinder as a least-squares problem: whitened pressure errors over windows."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.computed_columns import shown_noise
from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.excerpt import excerpts, kept_back, led_to_test, training_part
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.discrepancy.trace import Trace
from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.effort import Effort
from exo_sim.diagnosis.estimation.kept_residuals import KeptResiduals
from exo_sim.diagnosis.estimation.least_squares import Derivatives, Fit, fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Values, card_delays
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.findings import Finding, Series, Subsystem
from exo_sim.diagnosis.nominal_numbers import DEAD_VOLUME
from exo_sim.diagnosis.policy import healthy, significance, verdicts
from exo_sim.diagnosis.subsystem_model import Comparison, SubsystemModel
from exo_sim.diagnosis.subsystems.gas.bursts import burst_ratio, fast_errors
from exo_sim.diagnosis.subsystems.gas.experiments import menu
from exo_sim.diagnosis.subsystems.gas.form_errors import error_of_form
from exo_sim.diagnosis.subsystems.gas.healthy_discrepancy import healthy_discrepancy
from exo_sim.diagnosis.subsystems.gas.healthy_limits import with_healthy_losses
from exo_sim.diagnosis.subsystems.gas.hose_step import affordable_step
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs, inputs
from exo_sim.diagnosis.subsystems.gas.missing_flow import missing_flow
from exo_sim.diagnosis.subsystems.gas.prediction import GasPrediction, behind_hose, effort_of
from exo_sim.diagnosis.subsystems.gas.regimes import regimes
from exo_sim.diagnosis.subsystems.gas.row_set import START_STEP, RowSet
from exo_sim.diagnosis.subsystems.gas.sensed_prediction import sensed
from exo_sim.diagnosis.subsystems.gas.unknown_curve import with_curve
from exo_sim.physics.declaration import identification_of
from exo_sim.physics.effects import critical_ratio as flow_law
from exo_sim.physics.nozzle import critical_ratio

Array = NDArray[np.float64]

#: Length of a window [s]. Short windows hide slow effects: a fifth to a third of the heat transfer at 0.4 s.
WINDOW = 1.2
#: Length of the windows over which reported errors are predicted [s].
REPORTED_WINDOW = 0.5
#: Fewest samples of a window.
FEWEST_SAMPLES = 150
#: A recording at rest is cut into no more windows than this.
REST_WINDOWS = 5


class GasModel(SubsystemModel):
    """The gas of one cylinder, any number of runs.

    The initial pressures of the windows, which noisy sensors tell only roughly, are marginalised.

    Args:
        runs: The runs, each with a position and at least one pressure.
        nominal: The nominal plant.
        split: Which time may be used.
        window: Length of a window [s].
        on_test: Whether the rows are those of the test time; predictions then cover the whole runs.
        effort: Where predicted samples are counted: with another model's, or by themselves where absent.

    Attributes:
        effort: The same; other forms of this model count there as well.
    """

    kind = Subsystem.GAS
    balance = "energy balance"
    hopeless_ratio = verdicts.HOPELESS_GAS
    demands_larger_part = True  # no two valves are alike
    calibrates_pressures = True
    unit = "Pa"

    def __init__(
        self, runs: Sequence[CylinderRun], nominal: PlantParameters, split: Split, window: float | None = None, on_test: bool = False,
        effort: Effort | None = None,
    ):  # fmt: skip
        if window is None:
            window = max(WINDOW, FEWEST_SAMPLES * max(float(np.median(np.diff(run.time))) for run in runs))
            if all(run.at_rest for run in runs):
                window = max(window, max(float(np.ptp(run.time)) for run in runs) / REST_WINDOWS)
        self.where, self.nominal, self.all_runs = runs[0].cylinder, nominal, tuple(runs)
        trained = (training_part(run, split) for run in runs)
        fitted = (list(runs), split) if on_test else excerpts([run for run in trained if run is not None], split)
        self.runs, self.split = fitted
        self._is_cut, self._is_reported = self.split is not split, on_test
        self.inputs: list[GasInputs] = [inputs(run, nominal.world, window) for run in self.runs]
        self._set = RowSet(self.inputs, nominal, self.split, on_test)
        self.blocks = self._set.blocks()
        self._responses: list[list[Array]] | None = None
        self._kept = KeptResiduals()
        self.effort = effort or Effort()

    @property
    def practical_significance(self) -> float:
        return significance.GAS_SIGNIFICANT * self._level / self._set.usual_scale

    @property
    def discrepancy_bound(self) -> float:
        return self.structural_error / self._set.usual_scale

    @property
    def structural_error(self) -> float:
        driven = [float(np.nanmean(one.supply)) for one in self.inputs if one.run.commanded]
        level = max(self._level, healthy.USUAL_LEVEL * max(driven, default=0.0))
        return healthy.GAS_BOUND * significance.GAS_SIGNIFICANT * level

    @property
    def _level(self) -> float:
        """Mean pressure of the chamber in which it is higher [Pa]."""
        return max((float(np.nanmean(p)) for run in self.runs for p in run.pressure if p is not None), default=0.0)

    @property
    def scale(self) -> Array:
        """Standard deviation that noise and what happened between samples leave in each row [Pa], shape (size,)."""
        return self._set.scale

    @property
    def recordings(self) -> NDArray[np.str_]:
        """Of which recording each row is, shape (size,)."""
        return self._set.recordings

    @cached_property
    def _stepped(self) -> list[GasInputs]:
        """The inputs for sensors behind a hose: steps as long as the noise of the rows affords in a fit, the usual ones in a report."""
        if self._is_reported or not self.size:
            return self.inputs
        step = affordable_step(self.inputs, self._set, self.nominal)
        return [replace(one, hose_step=step) for one in self.inputs]

    def predict(self, plant: PlantParameters, index: int, shift: float = 0.0, whole: bool = True) -> GasPrediction:
        """Predict what the sensors of one run would show; arguments as of `sensed`."""
        given = (self._stepped if behind_hose(plant.cylinder) else self.inputs)[index]
        found = sensed(given, plant, shift, whole)
        self.effort.add(effort_of(found.samples, given.period, plant.cylinder))
        return found

    def errors(self, plant: PlantParameters) -> list[Array]:
        """Return measured less predicted pressure of every run, shape (n, 2) [Pa]; NaN where nothing was measured."""
        found = []
        for index, given in enumerate(self.inputs):
            pressure = self.predict(plant, index, whole=False).pressure
            for side, measured in enumerate(given.run.pressure):
                np.subtract(math.nan if measured is None else measured, pressure[:, side], out=pressure[:, side])
            found.append(pressure)
        return found

    def residual_of(self, plant: PlantParameters) -> Array:
        return self._kept.of(plant, self._predicted_residual)

    def _predicted_residual(self, plant: PlantParameters) -> Array:
        return self.as_rows(self.errors(plant))

    def as_rows(self, errors: Sequence[Array]) -> Array:
        """Return errors of every run, shape (n, 2) each [Pa], as whitened rows with the windows' initial pressures integrated out."""
        if self._responses is None:
            self._responses = self._set.responses(self._pushed(index) for index in range(len(self.inputs)))
        return self._set.whitened(errors, self._responses)

    def _pushed(self, index: int) -> Array:
        """Return how initial pressures that are `START_STEP` higher change the prediction of a run, shape (n, 2) [Pa]."""
        change = self.predict(self.nominal, index, START_STEP, whole=False).pressure
        change -= self.predict(self.nominal, index, whole=False).pressure
        return change

    def with_better_flow_law(
        self, nuisances: Sequence[FreeParameter], threads: Threads = SERIAL, is_spent: IsSpent = never
    ) -> tuple[GasModel, Fit]:
        """Return the model under the form of the paper's flow law that fits better, with that fit: the nozzle, or the ellipse near it.

        The two differ by at most 0.152 % of choked flow; a healthy valve may follow either, and neither is a finding.
        """
        start = {q: q.start for q in nuisances}
        own = fit(self.residual, nuisances, start, threads, max_iterations=4, derivatives=Derivatives({}), is_spent=is_spent)
        if float(self.nominal.cylinder[flow_law.EFFECT.name]["ratio"][0]) > 0.0:
            return self, own
        rival = copy(self)
        rival._kept = KeptResiduals()
        rival.nominal = self.nominal.copy()
        rival.nominal.cylinder[flow_law.EFFECT.name]["ratio"] = critical_ratio(float(self.nominal.world["k"][0]))
        other = fit(
            rival.residual, nuisances, own.values, threads, max_iterations=4, derivatives=Derivatives(own.columns), is_spent=is_spent,
        )
        return (rival, other) if other.sse < own.sse else (self, own)

    def healthy_discrepancy(self, plant: PlantParameters) -> DiscrepancyBasis:
        return healthy_discrepancy(self, plant)

    def pressures(self, plant: PlantParameters) -> list[Array]:
        """Return the predicted pressures of every run, shape (n, 2) each [Pa]."""
        return [self.predict(plant, index, whole=False).pressure for index in range(len(self.runs))]

    def over_whole_runs(self, plant: PlantParameters, split: Split) -> GasModel:
        """Return the model that predicts the whole runs, of this plant; its rows are those of the test time."""
        return GasModel(self.all_runs, plant, split, on_test=True)

    @classmethod
    def over_test_time(cls, runs: Sequence[CylinderRun], nominal: PlantParameters, split: Split) -> GasModel:
        """Return the model of the test time of runs, over windows as reported errors are."""
        back = [run for run in (kept_back(run, split) for run in runs) if run is not None]
        return cls(back or runs, nominal, split, REPORTED_WINDOW, on_test=True)

    def on_test_time(self, split: Split) -> GasModel:
        return self.over_test_time(self.all_runs, self.nominal, split)

    def in_one_run(self, split: Split) -> GasModel:
        runs = [led_to_test(run, split, sum(len(one.time) for one in self.all_runs)) for run in self.all_runs]
        whole = GasModel(runs, self.nominal, split, math.inf, on_test=True)
        whole._responses = whole._set.no_responses()
        return whole

    def healthy_variants(self, plant: PlantParameters) -> tuple[PlantParameters, ...]:
        return with_healthy_losses(plant)

    def compared(self, before: PlantParameters, after: PlantParameters, curve: Curve | None = None) -> list[Comparison]:
        pressures = [self.pressures(before)]
        pressures.append(pressures[0] if after is before else self.pressures(after))
        found = []
        for side in range(2):
            for index, run in enumerate(self.runs):
                measured = run.pressure[side]
                if measured is None:
                    continue
                mask = self.split.in_test(run.recording, run.time) & self.inputs[index].windows.compared
                first, second = (predicted[index][:, side] for predicted in pressures)
                column, noise = f"{self.where}.pressure_{side + 1}", shown_noise(run.noise[side], measured, run.computed)
                series = Series(run.recording, column, self.unit, run.time, measured, first, second, noise)
                found.append(Comparison(series, (measured - first)[mask], (measured - second)[mask]))
        return found

    def traces(self, plant: PlantParameters) -> list[Trace]:
        found = []
        k = float(plant.world["k"][0])
        for given, errors, unsampled in zip(self.inputs, self.errors(plant), self._set.unsampled, strict=True):
            run = given.run
            errors[~given.windows.compared] = math.nan
            if self._is_cut:
                errors[~self.split.in_training(run.recording, run.time)] = math.nan
            for side in range(2):
                if run.pressure[side] is None:
                    continue
                noise = math.hypot(run.noise[side], healthy.GAS_FLOOR, float(np.sqrt(np.mean(unsampled[:, side] ** 2))))
                where = f"{self.where}/chamber_{side + 1}"
                found.append(
                    Trace(where, self.balance, self.unit, run.recording, given.time, errors[:, side], noise, regimes(given, side, k))
                )
        return found

    def discrepancies(self, plant: PlantParameters) -> tuple[Discrepancy, ...]:
        return tuple(self._missing(plant, side) for side in self._set.sides)

    def late_columns(self, delays: Mapping[str, float], data: MachineData) -> Mapping[str, float]:
        position, card = card_delays(delays)
        pressures = {f"{self.where}.pressure_{side}": card + delays.get(f"pressure_{side}.delay", 0.0) for side in (1, 2)}
        return {f"{data.joint_of(self.where)}.position": position, **pressures}

    def main_discrepancy(self, plant: PlantParameters) -> Discrepancy:
        loudest = max(self.traces(plant), key=lambda trace: trace.excess)
        return replace(self._missing(plant, int(loudest.where[-1]) - 1), bursts=self.has_bursts(plant))

    def _missing(self, plant: PlantParameters, side: int) -> Discrepancy:
        predictions = [(given, self.predict(plant, index)) for index, given in enumerate(self.inputs)]
        return missing_flow(predictions, plant, self.split, side, f"{self.balance} of chamber {side + 1}")

    def has_bursts(self, plant: PlantParameters) -> bool:
        along = zip(self.inputs, self.errors(plant), self._set.rows, strict=True)
        fast = [pair for given, errors, rows in along for pair in fast_errors(given.run, errors, rows)]
        return any(burst_ratio(one, noise) > healthy.BURSTS for one, noise in fast)

    def column(self, variable: str) -> str:
        return variable if variable == "time" else f"{self.where}.{variable}"

    def is_observed(self, parameter: FreeParameter) -> bool:
        if parameter.effect != DEAD_VOLUME:
            return True
        side = int(parameter.parameter[-1]) - 1
        return any(run.pressure[side] is not None for run in self.runs)

    def error_of_form(
        self, parameter: FreeParameter, error: float, values: Values, fixed: Sequence[tuple[FreeParameter, float]] = ()
    ) -> float:
        return error_of_form(parameter, self.apply(values, fixed), self.nominal)

    def indistinguishable(self, findings: Sequence[Finding], fit: Fit) -> Mapping[tuple[str, str], tuple[str, ...]]:
        """Declared twins of what the gas feels: a supply's that nobody measured, and a leak past the piston of a single-acting cylinder."""
        single = float(self.nominal.cylinder["single_acting"][0]) > 0.0
        found = {}
        for finding in findings:
            twins = identification_of(finding.name).twins
            found[finding.at] = (*twins.like(finding.numbers, False), *(twins.in_one_chamber if single else ()))
        return {key: names for key, names in found.items() if names}

    def experiments(self, plants: Sequence[PlantParameters]) -> Mapping[str, Array]:
        found = {}
        for do, run in menu(self.all_runs[0], self.nominal).items():
            trial = GasModel([run], self.nominal, Split({}), window=2.0 * float(run.time[-1]))
            found[do] = np.stack([trial.means(plant) for plant in plants])
        return found

    def means(self, plant: PlantParameters) -> Array:
        """Return what a plant predicts of each row, in units of what noise and floor leave of it, shape (size,)."""
        return self._set.means(self.pressures(plant))

    def with_unknown(self, plant: PlantParameters, discrepancy: Discrepancy) -> PlantParameters:
        return with_curve(plant, discrepancy)
