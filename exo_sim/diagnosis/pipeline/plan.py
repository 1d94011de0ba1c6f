"""The plan of one round of a diagnosis, and its result."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, TypeVar

from exo_sim.diagnosis.coupling.piston_friction import Friction
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.budget import Budget
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.findings import Finding
from exo_sim.diagnosis.outcome.finding_probability import is_doubtful
from exo_sim.diagnosis.selection.nuisance_calibration import counted_back
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import UnknownEffect
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.supply.model import SupplyModel
from exo_sim.diagnosis.validation.held_out_errors import HeldOutErrors

#: Called with a few words on what is going on.
Progress = Callable[[str], None]
#: Effect and place that validation refuted or forces contradicted, and why.
Refuted = Mapping[tuple[str, str], str]


@dataclass(frozen=True)
class Plan:
    """The plan of a round.

    Attributes:
        split: The division of time.
        refuted: Effects that are not sought again.
        friction: Of pistons behind a transmission that gives; None while the forces have not been asked.
        refutations: How often effects were refuted on this division of time.
        upheld: Effects and places that are not refuted again: without them more was missed than before.
        budget: The time that all of it may take.
    """

    split: Split
    refuted: Refuted = field(default_factory=dict)
    friction: Friction | None = None
    refutations: int = 0
    upheld: frozenset[tuple[str, str]] = frozenset()
    budget: Budget = field(default_factory=Budget)

    @property
    def test_time(self) -> Hashable:
        """The test time of its division, to know results by that were found on it."""
        return tuple(sorted(self.split.test.items()))

    def without_refuted(self, candidates: Iterable[Candidate]) -> tuple[Candidate, ...]:
        """Return the candidates that have not been refuted."""
        return tuple(candidate for candidate in candidates if candidate.at not in self.refuted)


Model = TypeVar("Model", bound=SubsystemModel)
#: Whether a finding of a result is to be kept.
Keep = Callable[[SubsystemResult[SubsystemModel], Finding], bool]


class Change(Protocol):
    """What makes of a result another of the same subsystem."""

    def __call__(self, one: SubsystemResult[Model], /) -> SubsystemResult[Model]: ...


def _keeping(results: Sequence[SubsystemResult[Model]], keep: Keep) -> tuple[SubsystemResult[Model], ...]:
    return tuple(_with_findings(one, tuple(finding for finding in one.findings if keep(one, finding))) for one in results)


def _with_findings(one: SubsystemResult[Model], kept: tuple[Finding, ...]) -> SubsystemResult[Model]:
    """Return a result with these of its findings; a dead volume in which the owner counted a hose that is not among them holds it again."""
    gone = {finding.at for finding in one.findings} - {finding.at for finding in kept}
    return replace(one, findings=kept, deviations=counted_back(one.deviations, gone))


@dataclass(frozen=True)
class Results:
    """The results of all subsystems."""

    gas: tuple[SubsystemResult[GasModel], ...] = ()
    supply: tuple[SubsystemResult[SupplyModel], ...] = ()
    motion: tuple[SubsystemResult[MotionModel], ...] = ()

    @property
    def all(self) -> tuple[SubsystemResult[SubsystemModel], ...]:
        """All of them: gas, supply, motion."""
        return (*self.gas, *self.supply, *self.motion)

    def each(self, change: Change) -> Results:
        """Return the results, each changed."""
        return Results(tuple(map(change, self.gas)), tuple(map(change, self.supply)), tuple(map(change, self.motion)))

    def keeping(self, keep: Keep) -> Results:
        """Return the results with those findings that are to be kept."""
        return Results(_keeping(self.gas, keep), _keeping(self.supply, keep), _keeping(self.motion, keep))


@dataclass(frozen=True)
class Examination:
    """What comes out of a round.

    Attributes:
        data: The data, with what the subsystems changed in each other's.
        plan: The plan that it followed.
        results: Of all subsystems.
        unknown: Unknown effects.
        test: Errors on the test time.
        validation: Errors on the validation time; None where there is none.
        small: Findings that were taken back because they are too small to matter.
        contradicted: Faults of sensors that the gas asks for and forces speak against.
    """

    data: MachineData
    plan: Plan
    results: Results
    unknown: tuple[UnknownEffect, ...] = ()
    test: HeldOutErrors = field(default_factory=HeldOutErrors)
    validation: HeldOutErrors | None = None
    small: tuple[Finding, ...] = ()
    contradicted: Refuted = field(default_factory=dict)

    def holding_small(self, small: tuple[Finding, ...]) -> Examination:
        """Return it with these findings beside the others, not among them."""
        gone = {finding.at for finding in small}
        return replace(self, results=self.results.keeping(lambda _, finding: finding.at not in gone), small=small)

    @property
    def validation_ratio(self) -> float:
        """How much larger the validation error is than what the fit leaves; 0 without validation."""
        return self.validation.ratio if self.validation is not None else 0.0

    @property
    def checked(self) -> HeldOutErrors:
        """Errors on the validation time; of no subsystem where there is none."""
        return self.validation or HeldOutErrors()

    @property
    def shares(self) -> Mapping[str, float]:
        """What each finding explains of what is missing without it over the validation time, by `effect@where`.

        Of one that explains little beside something larger, and whose change is surely there, how much of that is. Not of those for or
        against which a small share says nothing.
        """
        found = {}
        for key, one in self.checked.tested.items():
            if not is_doubtful(one.share) or one.speaks_against:
                found[key] = one.share
            elif one.is_plain and one.is_shown:
                found[key] = min(one.amplitude, 1.0)
        return found
