"""The balance of forces of every joint and rod, searched and judged."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.data import open_questions
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.discrepancy.basis import joined
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.linear_family import LinearFamily
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters
from exo_sim.diagnosis.estimation.threads import Threads
from exo_sim.diagnosis.findings import Kind, OpenQuestion
from exo_sim.diagnosis.pipeline.damped_contact import damped_contact, is_better
from exo_sim.diagnosis.pipeline.plan import Plan, Progress
from exo_sim.diagnosis.policy.budgets import FORCES_UNTIL, GAS_UNTIL
from exo_sim.diagnosis.policy.recordings import FEWEST_ROWS
from exo_sim.diagnosis.policy.verdicts import AS_GOOD, PLAINLY_LESS_DAMPING
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.family_search import FamilySearch
from exo_sim.diagnosis.selection.fitted_model import SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.sensor_zero import zeros_of_forces_within
from exo_sim.diagnosis.selection.subset_weighing import SubsetWeighing
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.motion.breakaway import with_breakaway
from exo_sim.diagnosis.subsystems.motion.candidates import candidates, creeps_at
from exo_sim.diagnosis.subsystems.motion.contact_scatter import contact_scatter
from exo_sim.diagnosis.subsystems.motion.family import motion_family
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.nuisances import nuisance_parameters, with_damping, with_damping_if_too_large
from exo_sim.diagnosis.subsystems.motion.rows import one_way
from exo_sim.diagnosis.subsystems.motion.scales import MotionScales
from exo_sim.physics.declaration import Parameter, declared, identification_of
from exo_sim.physics.plant_records import CYLINDER
from exo_sim.rig import assembly

#: Beside the speed at which friction builds up these are tried, in units of it.
NEAR_CREEP = (1.0, 0.85, 1.18)
#: A joint's number becomes its piston's with this power of the lever between them, by unit.
_LEVER_POWERS = {"N": -1, "N s/m": -2, "N s^2/m^2": -3, "N/m": -2, "m": 1, "m/s": 1}


@dataclass(frozen=True)
class JudgedBalances:
    """Balances of forces that were judged: a round that asks the same of the very same balance gets the same answer.

    Attributes:
        results: By name, test time, which of the effects that they ask were refuted and how far off zeros can be, with the runs
            that were judged.
    """

    results: dict[tuple[Hashable, ...], tuple[tuple[MotionRun, ...], SubsystemResult[MotionModel]]] = field(default_factory=dict)

    def of(self, key: tuple[Hashable, ...], runs: Sequence[MotionRun]) -> SubsystemResult[MotionModel] | None:
        """Return the result of these runs; None where others were judged, for the gas corrected or imputed their pressures anew."""
        before, result = self.results.get(key, ((), None))
        return result if len(before) == len(runs) and all(one is other for one, other in zip(before, runs, strict=True)) else None


def examine_motion(
    data: MachineData, plan: Plan, threads: Threads, report: Progress, judged: JudgedBalances | None = None
) -> tuple[SubsystemResult[MotionModel], ...]:
    """Return the result of every balance of forces; joints are judged before the rods whose load cells are in their balances.

    Args:
        data, plan, threads, report: As in `examine`.
        judged: What earlier rounds judged of the same data.
    """
    judged, found = judged or JudgedBalances(), dict[str, SubsystemResult[MotionModel]]()
    joints_first = sorted(data.joints.items(), key=lambda one: one[1][0].drive.cylinder is not None)
    for number, (name, runs) in enumerate(joints_first):
        plan.budget.allow_until(GAS_UNTIL + (FORCES_UNTIL - GAS_UNTIL) * (number + 1) / len(data.joints))
        zeros = tuple((column, data.zeros_within.get(column)) for column in runs[0].drive.levers)
        key = (name, plan.test_time, _refuted_of(name, runs, data, plan), zeros)
        result = judged.of(key, runs)
        if result is None:
            result = examine_balance(name, runs, data, plan, threads, report)
            judged.results[key] = tuple(runs), result
        found[name] = result
        if runs[0].drive.cylinder is None:  # of a cell that is in the balance along its rod as well
            data = replace(data, zeros_within={**data.zeros_within, **zeros_of_forces_within(result)})
    return tuple(found[name] for name in data.joints)


def _refuted_of(name: str, runs: Sequence[MotionRun], data: MachineData, plan: Plan) -> frozenset[tuple[str, str]]:
    """Return which effects that a balance asks were refuted: one of the gas too, where a pressure was imputed."""
    asked = candidates(runs, nominal_balance(data, name, runs), runs[0].cylinder or runs[0].joint)
    return frozenset(one.at for one in asked if one.at in plan.refuted)


def judged_balances(data: MachineData, split: Split) -> int:
    """Return how many balances of forces have rows enough in the training time of a split."""
    every = (MotionModel(runs, nominal_balance(data, name, runs), split).size for name, runs in data.joints.items())
    return sum(size >= FEWEST_ROWS for size in every)


def balances_left_open(found: Sequence[SubsystemResult[MotionModel]]) -> tuple[OpenQuestion, ...]:
    """Return the question of every balance of forces that was recorded and has too few rows to be judged."""
    questions = []
    for one in found:
        if one.model.size < FEWEST_ROWS:
            run = one.model.runs[0]
            share = float(np.mean(np.abs(run.kinematics.velocity) > run.kinematics.still))
            seconds = one_way(run)
            if share * float(np.ptp(run.time)) > FEWEST_ROWS * seconds:
                questions.append(open_questions.of_quick_motion(run.joint, run.recording, seconds))
            else:
                questions.append(open_questions.of_little_motion(run.joint, run.recording, one.model.size, int(FEWEST_ROWS), seconds))
    return tuple(questions)


def undecided(found: Sequence[SubsystemResult[MotionModel]]) -> tuple[OpenQuestion, ...]:
    """Return the question of every effect that nuisance parameters stand in for, unless it was found after all."""
    return tuple(
        open_questions.of_undecided(one.effect, wording.name_of(one.effect), one.where, declared()[one.effect].experiment)
        for result in found
        for one in result.search.undecided
        if one.effect in declared() and one.effect not in {finding.name for finding in result.findings}
    )


def examine_balance(
    name: str, runs: Sequence[MotionRun], data: MachineData, plan: Plan, threads: Threads, report: Progress
) -> SubsystemResult[MotionModel]:
    """Return the result of one balance of forces.

    Args:
        name: Of the joint or rod.
        runs: Its balance in every recording.
        data, plan, threads, report: As in `examine`.
    """
    is_spent = plan.budget.is_spent
    model = MotionModel(runs, nominal_balance(data, name, runs), plan.split)
    nuisances = with_damping_if_too_large(model, nuisance_parameters(runs, model.nominal, model.where))
    asked = asked_of(model, data, plan)
    report(f"{name}: weighing {len(asked)} effects side by side")
    standing = [one.name for one in declared().values() if one.cut == "motion" and model.nominal.is_on(one)]
    if model.size >= FEWEST_ROWS:
        every = SubsetWeighing(motion_family(model, nuisances, asked, soft=False), model.discrepancy_basis(), model.blocks, standing)
        model = with_breakaway(model.with_contact(contact_scatter(every.left_by_everything(), model.speed)))
        asked = asked_of(model, data, plan, model.slowest_resolved, model.creeps_below)

    def search_once(
        model: MotionModel, nuisances: Sequence[FreeParameter], asked: Sequence[Candidate],
        contacts: Sequence[Mapping[FreeParameter, float]] = (),
    ) -> tuple[ModelFits, SearchResult]:  # fmt: skip
        fits = ModelFits(model, nuisances, threads, True, is_spent)
        if model.size < FEWEST_ROWS:
            return fits, FamilySearch(fits, LinearFamily((), ()), joined((), 0)).run()
        family = motion_family(model, nuisances, asked, contacts=contacts, is_spent=is_spent)
        return fits, FamilySearch(fits, family, model.discrepancy_basis(), standing).run()

    def search(nuisances: Sequence[FreeParameter]) -> tuple[ModelFits, SearchResult]:
        fits, found = search_once(model, nuisances, asked)
        for parameter, creep in creeps_at(found.final.fit.values).items():
            weighted = model.with_contact(None, creep)
            if weighted.creeps and not is_spent():
                return search_once(weighted, nuisances, asked, [{parameter: creep * share} for share in NEAR_CREEP])
        if model.is_of_joint or is_spent():
            return fits, found
        damped = damped_contact(found.final, fits, asked, MotionScales.of(model).level)
        if damped is None or is_spent():
            return fits, found
        other, again = search_once(model, nuisances, (*asked, damped.candidate), damped.near)
        return (other, again) if is_better(again.final, found.final, other) else (fits, found)

    held, outcome = search(nuisances)
    freed = with_damping(model, nuisances)
    if freed and not is_spent() and _may_be_damping(outcome, ModelFits(model, freed, threads, True, is_spent)):
        other, rival = search(freed)
        more = rival.final.parameter_count - outcome.final.parameter_count
        if more <= 0 and other.deficit(rival.final, outcome.final) < (AS_GOOD if more < 0 else -PLAINLY_LESS_DAMPING):
            return decide(name, cast(MotionModel, other.model), other, rival)
    return decide(name, cast(MotionModel, held.model), held, outcome)


def asked_of(model: MotionModel, data: MachineData, plan: Plan, *seen: float) -> tuple[Candidate, ...]:
    """Return the candidates of a balance that were not refuted, zeros no further off than others let them be: of pressures the gas, of a
    load cell the balance of its joint.

    A zero that is further off looks like dry friction that differs by direction, which neither sees.

    Args:
        model: The balance.
        data, plan: As in `examine`.
        seen: What its contact shows, the further arguments of `candidates`.
    """
    every = plan.without_refuted(candidates(model.runs, model.nominal, model.where, *seen))
    return tuple(_bounded(one, data.zeros_within[one.where]) if _is_zero_of(one, data.zeros_within) else one for one in every)


def _is_zero_of(candidate: Candidate, columns: Collection[str]) -> bool:
    return candidate.kind is Kind.SENSOR and candidate.where in columns


def _bounded(zero: Candidate, most: float) -> Candidate:
    """Return the zero of a sensor that is off by so much at most."""
    (q,) = zero.parameters
    start = min(zero.starts[0][0], 0.5 * most)
    return replace(zero, parameters=(replace(q, low=-most, high=most, scale=min(q.scale, 0.5 * most)),), starts=((start,),))


def _may_be_damping(outcome: SearchResult, freed: ModelFits) -> bool:
    """Return whether nominal damping that is too large may explain what was found: it looks like that, or less of it gains plainly."""
    chosen = outcome.final.candidates
    looks_like = {identification_of(one.effect).twins.damping for one in chosen}
    if -1 in looks_like:
        return True
    if not chosen or 1 in looks_like:
        return False
    return freed.deficit(freed.fit(chosen, outcome.final), outcome.final) < -PLAINLY_LESS_DAMPING


def nominal_balance(data: MachineData, name: str, runs: Sequence[MotionRun]) -> PlantParameters:
    """Return the nominal plant; what the rig says of the joint's own friction and springs is added to its piston's."""
    cylinder = runs[0].cylinder
    if cylinder is None:
        record, arm = np.zeros(1, CYLINDER), 1.0
    else:
        index = list(data.rig.cylinders).index(cylinder)
        record, arm = assembly.cylinders(data.rig)[index : index + 1], runs[0].drive.usual_arm
    return PlantParameters(assembly.world(data.rig), _with_joint_effects(data, name, record, arm))


def _with_joint_effects(data: MachineData, joint: str, piston: NDArray[np.void], arm: float) -> NDArray[np.void]:
    """Return the record of a piston with the effects of its joint, which it feels through its lever `arm` [m/rad, or 1].

    What stands in the rig at a name that a cylinder has is that cylinder's, whatever the joint is called.

    Sizes of both add up; a shape (the speed of a dip, where a spring is slack) is the mean of both, weighted by size: of springs that is
    what two of them are together.
    """
    record = piston.copy()
    for effect in () if joint in data.rig.cylinders else data.rig.effects:
        if effect.where != joint or effect.name not in (record.dtype.names or ()):
            continue
        declares, own = declared()[effect.name], record[effect.name]
        at_piston = {name: value * arm ** _LEVER_POWERS.get(declares.parameter(name).unit, 0) for name, value in effect.parameters.items()}
        sizes = [name for name in at_piston if _is_size(declares.parameter(name))]
        added, held = (sum(abs(float(one[name])) for name in sizes) for one in (at_piston, own[0]))
        for name, value in at_piston.items():
            before = float(own[name][0])
            if name in sizes:
                own[name] = before + value
            elif before == 0.0 or held == 0.0:
                own[name] = value
            elif added > 0.0:
                own[name] = (held * before + added * value) / (held + added)
    return record


def _is_size(parameter: Parameter) -> bool:
    """Return whether a parameter says how large an effect is: nil is then one of its values."""
    return parameter.low <= 0.0 and (parameter.required or parameter.unit != "m")
