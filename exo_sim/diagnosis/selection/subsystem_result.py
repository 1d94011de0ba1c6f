"""The result of examining one subsystem."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters
from exo_sim.diagnosis.findings import Finding, Rejected, Subsystem
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nuisance_calibration import Deviation
from exo_sim.diagnosis.subsystem_model import SubsystemModel

Model = TypeVar("Model", bound=SubsystemModel, covariant=True)


@dataclass(frozen=True)
class SubsystemResult(Generic[Model]):
    """What one subsystem says.

    Attributes:
        name: What identifies the subsystem among those of its kind: the cylinder, the joint, "rod of CYLINDER", or "supply".
        model, fits, search: How it was found.
        final: The model that is accepted in the end.
        named: Those of its candidates that stand as findings.
        has_unknown: Whether something is missing that no candidate explains.
        is_unresolved: Whether what is left cannot be distinguished from what an unmeasured chamber may do.
        findings, rejected: For the report.
        deviations: Nominal numbers that are off, for the report.
        refitted: Nuisance parameters that are no finding but that the improved rig should hold as fitted, with standard errors.
    """

    name: str
    model: Model
    fits: ModelFits
    search: SearchResult
    final: FittedModel
    named: tuple[Candidate, ...] = ()
    has_unknown: bool = False
    is_unresolved: bool = False
    findings: tuple[Finding, ...] = ()
    deviations: tuple[Deviation, ...] = ()
    rejected: tuple[Rejected, ...] = ()
    refitted: tuple[tuple[FreeParameter, float], ...] = ()

    @property
    def key(self) -> tuple[Subsystem, str]:
        """What identifies it among all results."""
        return self.model.kind, self.name

    @property
    def where(self) -> str:
        """The cylinder, joint or shared part."""
        return self.model.where

    @property
    def is_empty(self) -> bool:
        """Whether there were too few data to examine."""
        return self.model.size == 0 or self.final.fit.residual.size == 0

    @property
    def final_plant(self) -> PlantParameters:
        """The plant as the final model has it."""
        return self.plant_of(self.final)

    def plant_of(self, fitted: FittedModel) -> PlantParameters:
        """Return the plant as a fitted model has it."""
        return self.model.apply(fitted.fit.values, fitted.fixed)
