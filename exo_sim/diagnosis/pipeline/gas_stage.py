"""The gas of every cylinder, searched and judged."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from exo_sim.diagnosis.coupling.imputed_pressure import with_initial_pressure
from exo_sim.diagnosis.coupling.piston_friction import softens
from exo_sim.diagnosis.data.command_sign import reversed_command
from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.sampled_commands import remark
from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.estimation.correlation import correlation_time
from exo_sim.diagnosis.estimation.effort import Allowance, Effort
from exo_sim.diagnosis.estimation.least_squares import Derivatives, Fit, fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH, standard_errors
from exo_sim.diagnosis.pipeline.command_reading import as_sampled, read_as_sampled
from exo_sim.diagnosis.pipeline.plan import Plan, Progress
from exo_sim.diagnosis.policy.acceptance import SHARE_OF_THE_REST
from exo_sim.diagnosis.policy.budgets import FELT_TOLERANCE, FEW_SAMPLES, FORCES_UNTIL, GAS_UNTIL, LEAST_LATER, MOST_EFFORT
from exo_sim.diagnosis.policy.priors import INITIAL_WARMTH, ROOM_WARM
from exo_sim.diagnosis.policy.recordings import FEWEST_ROWS, HELD_AT_FIRST, HELD_IN_THE_END, REVERSED
from exo_sim.diagnosis.policy.verdicts import UNKNOWN_VARIANCE
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.nuisances_beyond_prior import relieved
from exo_sim.diagnosis.selection.search import Search, StoppingCriteria, WarmStart
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.candidates import candidates, sample_period
from exo_sim.diagnosis.subsystems.gas.initial_temperature import initial_temperatures
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.gas.nuisances import healthy_walls, known_effects, nuisance_parameters, with_measured_supply
from exo_sim.rig import assembly

_ENDED = (
    "the search of its gas ended after the most predictions that are made; what it found until then is the answer, what it did not come to "
    "is not ruled out, and of a shorter recording more is asked"
)


@dataclass(frozen=True)
class Searched:
    """Results of searches that are over: a round that asks the same of a cylinder's gas gets the same answer.

    Attributes:
        results: By cylinder, test time, candidates and friction of the piston.
        stopped: Those of them that sought nothing more after the most predictions.
        efforts: By cylinder, how many samples were predicted to get its results, and those that were given up for them.
    """

    results: dict[tuple[Hashable, ...], SubsystemResult[GasModel]] = field(default_factory=dict)
    stopped: set[tuple[Hashable, ...]] = field(default_factory=set)
    efforts: dict[str, int] = field(default_factory=dict)

    def of_other_time(self, cylinder: str, test_time: Hashable, asked: Sequence[Candidate]) -> FittedModel | None:
        """Return the latest model of a cylinder's gas in another division of the time, with those of its effects that are asked; or None.

        Args:
            cylinder, test_time: Of the search that is to begin.
            asked: Its candidates.
        """
        return self._latest(cylinder, asked, lambda time, _: time != test_time)

    def start_of(self, cylinder: str, test_time: Hashable, friction: Hashable, asked: Sequence[Candidate]) -> WarmStart:
        """Return where a search begins.

        All candidates are asked together once for the same rows. The friction of a piston changes the answer only where a transmission
        gives: beside what an ended search found without it, they are asked again only where one was found.

        Args:
            cylinder, test_time, friction, asked: Of the search that is to begin.
        """
        if (standing := self.standing(cylinder, test_time, friction, asked)) is not None:
            return WarmStart(begun=standing, asks_together=lambda _: False)
        before = self._latest_result(cylinder, lambda time, known: time == test_time and known != friction)
        if before is None:
            return WarmStart(begun=self.of_other_time(cylinder, test_time, asked))
        ended = not before.search.interrupted and all(self.results[key] is not before for key in self.stopped)
        once = ended and not softens(before.search.final)
        return WarmStart(begun=_asked_of(before.search.final, asked), asks_together=softens if once else lambda _: True)

    def allowed(self, cylinder: str, effort: Effort) -> Allowance:
        """Return how many samples the next search of a cylinder's gas may predict: what is left of the most, and no less than the least.

        Args:
            cylinder: Its name.
            effort: Where the search counts, and searches before it whose effort does not stand in `efforts` yet.
        """
        spent = self.efforts.get(cylinder, 0) + effort.samples
        return Allowance(effort, max(MOST_EFFORT - spent, int(LEAST_LATER * MOST_EFFORT)))

    def keep(self, key: tuple[Hashable, ...], result: SubsystemResult[GasModel], stopped: bool) -> None:
        """Keep what searches of one gas ended with, and all that they predicted together.

        Args:
            key: What was asked, the cylinder first.
            result: Of the last of them.
            stopped: Whether that sought nothing more after the most predictions.
        """
        self.results[key] = result
        self.efforts[result.name] = self.efforts.get(result.name, 0) + result.model.effort.samples
        if stopped:
            self.stopped.add(key)

    def sampled(self, cylinder: str) -> frozenset[str]:
        """Return in which recordings the commands of a cylinder were found to be samples of a quicker loop."""
        searched = [one.model.all_runs for (name, *_), one in self.results.items() if name == cylinder]
        return frozenset(run.recording for runs in searched for run in runs if run.sampled)

    def standing(
        self, cylinder: str, test_time: Hashable, friction: Hashable, asked: Sequence[Candidate]
    ) -> FittedModel | None:
        """Return what the latest search of the same time found, with those of its effects that are asked; or None.

        A search that asks less than one before it, for validation refuted something, need not find the rest anew.

        Args:
            cylinder, test_time, friction, asked: Of the search that is to begin.
        """
        return self._latest(cylinder, asked, lambda time, known: (time, known) == (test_time, friction))

    def _latest(
        self, cylinder: str, asked: Sequence[Candidate], is_meant: Callable[[Hashable, Hashable], bool]
    ) -> FittedModel | None:
        """Return the model of the latest search of a cylinder that is meant, by its test time and friction, with what is asked of it."""
        latest = self._latest_result(cylinder, is_meant)
        return None if latest is None else _asked_of(latest.search.final, asked)

    def _latest_result(self, cylinder: str, is_meant: Callable[[Hashable, Hashable], bool]) -> SubsystemResult[GasModel] | None:
        """Return the latest result of a cylinder that is meant, by its test time and friction."""
        meant = [
            one for (name, time, _, friction), one in self.results.items()
            if name == cylinder and is_meant(time, friction) and not one.is_empty
        ]  # fmt: skip
        return meant[-1] if meant else None


def _asked_of(found: FittedModel, asked: Sequence[Candidate]) -> FittedModel:
    """Return a fitted model with those of its candidates that are asked, as they are asked."""
    before = {one.key for one in found.candidates}
    return replace(found, candidates=drop_orphans([one for one in asked if one.key in before]))


def examine_gas(
    data: MachineData, plan: Plan, threads: Threads, report: Progress, searched: Searched | None = None
) -> tuple[MachineData, tuple[SubsystemResult[GasModel], ...]]:
    """Return the result of every cylinder's gas, and the data with initial pressures and signs of valve commands as found.

    Args:
        data, plan, threads, report: As in `examine`.
        searched: What earlier rounds searched.

    While the plan does not know the friction of pistons, a search ends at a transmission that gives if there are forces to ask.
    """
    searched = searched or Searched()
    found, done = [], searched.results
    for number, name in enumerate(data.cylinders):
        plan.budget.allow_until((GAS_UNTIL if data.joints else FORCES_UNTIL) * (number + 1) / len(data.cylinders))
        runs = [with_initial_pressure(data, run) for run in data.cylinders[name]]
        plant = nominal_gas(data, plan, name, runs)
        model = GasModel(runs, plant, plan.split)
        if model.size >= FEWEST_ROWS and (turned := _better_turned(model, plan)) is not None:
            model = turned
            data = replace(data, sensors=(*data.sensors, reversed_command(name)))
        data = replace(data, cylinders={**data.cylinders, name: model.all_runs})
        commanded = any(run.commanded for run in runs)
        sides = [side for side in (1, 2) if any(run.pressure[side - 1] is not None for run in runs)]
        at_rest = all(run.at_rest for run in runs)
        moves = any(run.moves for run in runs)
        supplied = all(run.supply is not None for run in runs)
        period = sample_period(runs)
        nuisances = nuisance_parameters(plant, name, commanded, sides, at_rest, moves, supplied, period)
        nuisances += known_effects(plant, name, period)
        joint = data.joint_of(name)
        asked = plan.without_refuted(candidates(plant, runs, name, joint))
        friction = None if plan.friction is None else tuple(plan.friction.get(name, ()))
        key = (name, plan.test_time, tuple(one.key for one in asked), friction)
        if key not in done:
            begun = searched.start_of(name, plan.test_time, friction, asked)
            soft = softens if plan.friction is None and joint in data.joints else None
            seek = partial(_searched, nuisances=nuisances, asked=asked, soft=soft, plan=plan, threads=threads, report=_naming(report, name))
            if model.size >= FEWEST_ROWS:
                model = as_sampled(model, plan.split, searched.sampled(name))
                free = {q: q.start for q in nuisances}
                model = read_as_sampled(model, plan.split, free, (), HELD_AT_FIRST, False, threads, plan.budget.is_spent)
            allowed = searched.allowed(name, model.effort)
            held = seek(model, begun, allowed=allowed)
            result, end = held, held.final
            if model.size >= FEWEST_ROWS:
                loud = held.has_unknown or end.fit.sse > UNKNOWN_VARIANCE * held.model.size
                other = read_as_sampled(
                    held.model, plan.split, end.fit.values, end.fixed, HELD_IN_THE_END, loud, threads, plan.budget.is_spent,
                    end.fit.columns,
                )  # fmt: skip
                if other is not held.model:
                    allowed = searched.allowed(name, other.effort)
                    result = seek(other, begun, allowed=allowed)
            searched.keep(key, result, allowed.stopped)
        found.append(done[key])
        data = _with_readings(data, found[-1].model)
        if key in searched.stopped:
            data = replace(data, remarks=(*data.remarks, f"{name}: {_ENDED}"))
    return data, tuple(found)


def _with_readings(data: MachineData, model: GasModel) -> MachineData:
    """Return the data with the runs of a cylinder as they were judged, and a remark where its commands were read as samples."""
    commands = data.rig.cylinders[model.where].commands
    said = tuple(remark(run, commands) for run in model.all_runs if run.sampled)
    return replace(data, cylinders={**data.cylinders, model.where: model.all_runs}, remarks=(*data.remarks, *said))


def _searched(
    model: GasModel, begun: WarmStart, *, nuisances: tuple[FreeParameter, ...], asked: tuple[Candidate, ...],
    soft: Callable[[FittedModel], bool] | None, plan: Plan, threads: Threads, report: Progress, allowed: Allowance,
) -> SubsystemResult[GasModel]:
    """Return what a search of one gas found.

    Args:
        model: The gas.
        begun: Where it may begin.
        nuisances, asked: What is free in every fit, and the candidates.
        soft: When it may end before all is explained.
        plan, threads, report: As in `examine`.
        allowed: How much it may predict.
    """
    first = None
    if model.size >= FEWEST_ROWS:
        model, first = model.with_better_flow_law(nuisances, threads, plan.budget.is_spent)
        nuisances += felt_temperatures(model, first, threads, plan.budget.is_spent)
    search = Search(
        model, nuisances, asked, threads, report, cheap=sum(len(run.time) for run in model.all_runs) < FEW_SAMPLES,
        practical_significance=model.practical_significance,
        stopping=StoppingCriteria(soft, plan.budget.is_spent, allowed.is_used_up), start=replace(begun, first=first),
    )  # fmt: skip
    found = search.run()
    end, fits = relieved(found, search.fits, search.proposals, model, plan.split)
    if end.final.fit.sse < SHARE_OF_THE_REST * found.final.fit.sse:  # what was hidden may show
        end = search.shown_beside(end, fits)
    return decide(model.where, model, fits, end, plan.split)


def nominal_gas(data: MachineData, plan: Plan, cylinder: str, runs: Sequence[CylinderRun]) -> PlantParameters:
    """Return the nominal plant, without what was measured, with the friction that the plan knows."""
    index = list(data.rig.cylinders).index(cylinder)
    drives = {link.cylinder: link.joint for link in data.links}
    nominal = PlantParameters(assembly.world(data.rig), assembly.cylinders(data.rig, drives)[index : index + 1])
    return with_measured_supply(nominal, runs).with_values((plan.friction or {}).get(cylinder, ()))


def felt_temperatures(model: GasModel, near: Fit, threads: Threads = SERIAL, is_spent: IsSpent = never) -> tuple[FreeParameter, ...]:
    """Return the temperatures of the gas at the start of its recordings that are to be free: none where all are surely the room's.

    Only walls make them felt: those of a healthy machine are fitted with them where the rig says nothing of walls. Beside an error that
    is large they are not known, and free.

    Args:
        model: The gas.
        near: A fit of its nuisance parameters.
        threads: Threads.
        is_spent: Whether the time is up.
    """
    asked = initial_temperatures(model.all_runs)
    if not asked:
        return ()
    walls = healthy_walls(model.nominal, model.where)
    free = tuple({q.key: q for q in (*near.parameters, *walls, *asked)}.values())
    start = {q: near.values.get(q, q.start or (q.scale if q in walls else 0.0)) for q in free}
    known = near.columns if set(walls) <= set(near.parameters) else None  # beside walls the same numbers act otherwise
    found = fit(model.residual, free, start, threads, tolerance=FELT_TOLERANCE, derivatives=Derivatives(known), is_spent=is_spent)
    errors = standard_errors(model, found, correlation_time(found.residual, model.blocks))
    return () if all(_is_of_the_room(found.values[q], errors[q]) for q in asked) else asked


def _is_of_the_room(warmth: float, error: float) -> bool:
    """Return whether a temperature above the room's is nil as far as anybody can tell, and that is far enough [K]."""
    return abs(warmth) < HALF_WIDTH * error and abs(warmth) + HALF_WIDTH * error < ROOM_WARM * INITIAL_WARMTH


def _better_turned(model: GasModel, plan: Plan) -> GasModel | None:
    """Return the model with commands of the other sign, where that leaves by far less."""
    opposite = GasModel([run.turned for run in model.all_runs], model.nominal, plan.split)
    less = np.sum(opposite.residual({}) ** 2) < REVERSED * np.sum(model.residual({}) ** 2)
    return opposite if less else None


def _naming(report: Progress, part: str) -> Progress:
    """Return a progress that names the part it speaks of."""
    return lambda words: report(f"{part}: {words}")
