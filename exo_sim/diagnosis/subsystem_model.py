"""The one interface that every subsystem offers to selection, validation and outcome."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis, joined
from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.discrepancy.trace import Trace
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Values
from exo_sim.diagnosis.findings import Finding, Series, Subsystem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Comparison:
    """One measured signal with its predictions, and their errors on the time that was asked for, shape (k,) each."""

    series: Series
    error_before: Array
    error_after: Array


class SubsystemModel(ABC):
    """One subsystem of the plant, cut out at measured signals, on one part of the time.

    Measured inputs u go in, measured outputs y are predicted. For the parameters theta of the plant the whitened residual is

        r(theta) = S^-1 [y - f(u, theta)]

    its rows means over short groups of samples, S the standard deviation that sensor noise and a structural floor leave in a row. States
    that no sensor tells at the start of a window are marginalised. r'r is then, up to a constant, twice the negative log-likelihood of
    independent rows; how far rows are correlated is for `estimation.correlation` to say.

    Attributes:
        kind: Which subsystem.
        balance: The equation that it holds, in words.
        where: The cylinder, joint or shared part.
        unit: Of the errors before whitening.
        nominal: The nominal plant.
        blocks: Block of time of each row, shape (size,).
        hopeless_ratio: Residuals of more than so many times `discrepancy_bound` are not explained by naming effects.
        demands_larger_part: Whether an effect must explain the larger part of what is missing without it wherever something is left.
        plant_holds_curves: Whether the curve of an unknown effect can be put into a plant (see `with_unknown`).
        calibrates_pressures: Whether it says what the pressure sensors of its cylinder and their card show: another subsystem of the same
            cylinder then leaves them to it.
        is_input_of_others: Whether the others are predicted from its measured signal: what it lacks puts none of them off.
    """

    kind: ClassVar[Subsystem]
    balance: ClassVar[str]
    hopeless_ratio: ClassVar[float] = math.inf
    demands_larger_part: ClassVar[bool] = False
    plant_holds_curves: ClassVar[bool] = True
    calibrates_pressures: ClassVar[bool] = False
    is_input_of_others: ClassVar[bool] = False
    is_of_joint: bool = False
    where: str
    unit: str
    nominal: PlantParameters
    blocks: NDArray[np.int64]

    @property
    def size(self) -> int:
        """Number of rows."""
        return int(self.blocks.size)

    @property
    @abstractmethod
    def practical_significance(self) -> float:
        """Drop of the root mean square residual below which an effect is not worth naming."""

    @property
    @abstractmethod
    def discrepancy_bound(self) -> float:
        """Largest root mean square residual that the model of a healthy machine leaves."""

    @property
    def structural_error(self) -> float:
        """Largest error of a healthy machine's model in `unit`; 0 where no sensor's zero is fitted to it."""
        return 0.0

    @property
    def constant_of_zeros(self) -> float:
        """The greatest constant force that zeros of sensors within their data sheets make where friction acts [N or N m]."""
        return 0.0

    def apply(self, values: Values, fixed: Sequence[tuple[FreeParameter, float]] = ()) -> PlantParameters:
        """Return the nominal plant with these parameters changed."""
        return self.nominal.with_values((*values.items(), *fixed))

    def residual(self, values: Values, fixed: Sequence[tuple[FreeParameter, float]] = ()) -> Array:
        """Return the whitened residual for these parameters, shape (size,)."""
        return self.residual_of(self.apply(values, fixed))

    @abstractmethod
    def residual_of(self, plant: PlantParameters) -> Array:
        """Return the whitened residual of a plant, shape (size,)."""

    @abstractmethod
    def traces(self, plant: PlantParameters) -> list[Trace]:
        """Return the error of each balance along every recording."""

    @abstractmethod
    def discrepancies(self, plant: PlantParameters) -> tuple[Discrepancy, ...]:
        """Return what a plant misses, in each of the subsystem's balances."""

    def main_discrepancy(self, plant: PlantParameters) -> Discrepancy:
        """Return what a plant misses in the balance with the largest error."""
        return self.discrepancies(plant)[0]

    def discrepancy_over(self, plant: PlantParameters, variables: Sequence[str]) -> Discrepancy:
        """Return what a plant misses as that which depends on these variables, their curves first."""
        return self.main_discrepancy(plant)

    def healthy_discrepancy(self, plant: PlantParameters) -> DiscrepancyBasis:
        """Return what a healthy machine shows beside the numbers of a fit, as columns for the rows of the residual around a plant's."""
        return joined((), self.size)

    def healthy_misfit(self) -> Array:
        """Return what the laws of a healthy machine get wrong in each row, one standard deviation, shape (size,); 0 where nobody knows."""
        return np.zeros(self.size)

    def has_bursts(self, plant: PlantParameters) -> bool:
        """Return whether errors come in bursts too fast for the rows of the fit."""
        return False

    @abstractmethod
    def column(self, variable: str) -> str:
        """Return the column of the recording that a variable of a discrepancy curve stands for."""

    def is_observed(self, parameter: FreeParameter) -> bool:
        """Return whether the data hold a nuisance parameter, rather than whatever else is unknown at its place."""
        return True

    def error_of_form(
        self, parameter: FreeParameter, error: float, values: Values, fixed: Sequence[tuple[FreeParameter, float]] = ()
    ) -> float:
        """Return the standard error that the form of the equations leaves of a fitted parameter, beside that of the fit, in its unit.

        Args:
            parameter: The parameter.
            error: Its standard error by the fit.
            values, fixed: All that was fitted, and what was held.
        """
        return 0.0

    def as_sensor_error(self, parameter: FreeParameter, value: float) -> tuple[str, str, str, float] | None:
        """Return what a nuisance parameter says of a sensor: column, effect, its parameter and value; None where it says nothing."""
        return None

    def late_columns(self, delays: Mapping[str, float], data: MachineData) -> Mapping[str, float]:
        """Return by how much each column is late [s], given the delays that were fitted as nuisance parameters.

        Args:
            delays: By parameter, as `FreeParameter.parameter` has it [s].
            data: The machine that it is a part of.
        """
        return {}

    def indistinguishable(self, findings: Sequence[Finding], fit: Fit) -> Mapping[tuple[str, str], tuple[str, ...]]:
        """Return, by name and place of a finding, other effects that would look the same in this subsystem.

        Args:
            findings: Effects that were found.
            fit: The fit that they come from.
        """
        return {}

    def twins_of_number(self, parameter: FreeParameter) -> tuple[str, ...]:
        """Return effects that nothing in these recordings could tell from a nominal number that is off."""
        return ()

    def experiments(self, plants: Sequence[PlantParameters]) -> Mapping[str, Array]:
        """Return what plants predict of experiments that could be made, in units of what noise and floor leave of a row.

        Args:
            plants: The plants.

        Returns:
            By what is to be done, shape (plants, rows).
        """
        return {}

    @abstractmethod
    def on_test_time(self, split: Split) -> SubsystemModel:
        """Return the model whose rows are those of the test time; predictions run over half a second where they run over windows."""

    def in_one_run(self, split: Split) -> SubsystemModel | None:
        """Return the model that predicts each recording in one run from its first measured state, its rows those of the test time.

        Its rows are plain errors in units of the noise: one state is begun with, and what it is uncertain by is not taken off.
        None where rows are no predictions: a balance of forces is held against every moment, and nothing adds up in it unseen.
        """
        return None

    def healthy_variants(self, plant: PlantParameters) -> tuple[PlantParameters, ...]:
        """Return a plant with each imperfection of a healthy machine that it does not have and no nuisance parameter stands for."""
        return ()

    @abstractmethod
    def compared(self, before: PlantParameters, after: PlantParameters, curve: Curve | None = None) -> list[Comparison]:
        """Return every measured signal with what two plants predict, and the errors on this model's own time.

        Args:
            before, after: The plants.
            curve: Of an unknown effect, where the second plant cannot hold it (see `with_unknown`).
        """

    def with_unknown(self, plant: PlantParameters, discrepancy: Discrepancy) -> PlantParameters:
        """Return the plant with the curve of an unknown effect put in, as far as a plant can hold one."""
        return plant
