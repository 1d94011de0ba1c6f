"""The whole of a sizing: loads, search, choice, what the rig's own physics changes, and the closed loop that confirms it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from exo_sim.errors import RigError, ScenarioError, nearest
from exo_sim.outputs import replacing
from exo_sim.rig import Rig
from exo_sim.rig.catalogue import RATED_PRESSURE
from exo_sim.rig.own_catalogue import Catalogue, CatalogueValve
from exo_sim.sizing.ankle_motor import MotorDemand, ankle_motor
from exo_sim.sizing.confirmation import Confirmed
from exo_sim.sizing.coupled_stride import CoupledStride, Stride, mean_of
from exo_sim.sizing.design import fitted
from exo_sim.sizing.design_space import LEAST_SUPPLY, Space
from exo_sim.sizing.evaluation import Evaluator, Score, Task
from exo_sim.sizing.force_bandwidth import ForceBandwidth, force_bandwidths
from exo_sim.sizing.joint_kinds import JointKind, kinds_of
from exo_sim.sizing.loads import Condition, JointLoads, joint_loads
from exo_sim.sizing.published_machine import PublishedClass, published_class
from exo_sim.sizing.recommendation import Choice, nothing_found, recommended, shortlist
from exo_sim.sizing.rods import RodCheck, rod_checks
from exo_sim.sizing.search import Outcome, search, with_more
from exo_sim.sizing.sensitivity import Sensitivity, sensitivity
from exo_sim.sizing.sized_rig import sized_text
from exo_sim.sizing.unsized_joints import LeftAlone, kinds_left_alone, left_alone
from exo_sim.sizing.workers import Workers

#: Effects that a diagnosis may have found, by what a designer calls them.
GROUPS = {
    "friction": (
        "coulomb_friction", "viscous_friction", "stribeck_friction", "pressure_dependent_friction", "presliding",
        "asymmetric_friction", "quadratic_drag",
    ),
    "heat loss": ("wall_heat_transfer", "moving_wall_temperature"),
}  # fmt: skip
#: What a fixed number may be at the most, and how to say one that is more: valve area [m^2], distance from the axis [m], pressure [Pa].
_MOST = {
    "valve": (1e-3, "a valve of {0:g} m^2"), "from": (1.0, "an end {0:g} m from the axis"), "to": (1.0, "an end {0:g} m from the axis"),
    "supply": (1e7, "a supply of {0:g} Pa"),
}  # fmt: skip
#: Step [s] and cycles before the one that counts, when the chosen design is looked at again.
_FINE_STEP, _FINE_LEAD = 1e-3, 2.15
#: How many of its best each search gives to the others.
_SHARED = 15


@dataclass(frozen=True)
class Without:
    """What would have been chosen had the rig not this physics.

    Attributes:
        what: "friction", "heat loss", "any effect".
        choice: Of the search without it.
        same: Score of the recommended design without it.
    """

    what: str
    choice: Choice
    same: Score


@dataclass(frozen=True)
class Sizing:
    """Everything that a report tells.

    Attributes:
        task: What designs were judged by.
        loads: By condition.
        outcome: Of the search.
        choice: The recommended design.
        fine: The recommended design at half the time step, after two more cycles.
        without: What the rig's effects change.
        published: The published class beside it.
        sensitivity: What would change the recommendation.
        rods: What the walk with it asks of its rods.
        bandwidths: How fast one cylinder of each kind of joint follows the forces of that walk.
        motor: What the motor of a driven ankle must give, where there is one.
        others: What cylinders that are not sized can do with the recommended supply.
    """

    task: Task
    loads: tuple[JointLoads, ...]
    outcome: Outcome
    choice: Choice
    fine: Stride
    without: tuple[Without, ...]
    published: PublishedClass | None
    sensitivity: Sensitivity
    rods: tuple[RodCheck, ...] = ()
    bandwidths: tuple[ForceBandwidth, ...] = ()
    motor: MotorDemand | None = None
    others: tuple[LeftAlone, ...] = ()


def space_of(
    rig: Rig,
    reach: float,
    pressure_limit: float | None,
    joints: tuple[str, ...] = (),
    catalogue: Catalogue | None = None,
    fixed: Mapping[str, float] | None = None,
    springs: bool = False,
) -> Space:
    """Return the space of a rig.

    Args:
        rig: The owner's machine.
        reach: How far an attachment point may move [m].
        pressure_limit: Largest supply, absolute [Pa]; what the catalogue's cylinders are rated for when None.
        joints: To size; all that have cylinders when empty. The others stay as they are.
        catalogue: What may be bought; what comes along when None.
        fixed: Numbers that are not to be chosen, by name (`Space`).
        springs: Whether a spring may stand beside each rod.

    Raises:
        RigError: a limit that is no use, or a catalogue without the kind of valve that the rig has.
        ScenarioError: joints or fixed numbers that are not the rig's.
    """
    kinds, own = kinds_of(rig, joints), catalogue is not None
    if springs and not all(rig.cylinders[name].valve.independent for kind in kinds for name in kind.cylinders):
        raise RigError(
            f'{rig.path}: springs are chosen with the plan of both pressures: give the valves kind = "independent", or ask for '
            "--valves independent"
        )
    catalogue = catalogue or Catalogue()
    catalogue = replace(catalogue, valves=_valves_for(rig, kinds, catalogue))
    fixed = dict(fixed or {})
    atmosphere = rig.environment.pressure
    rated = max(one.rating for one in catalogue.cylinders)
    most = max(rated, RATED_PRESSURE + atmosphere) if pressure_limit is None else pressure_limit
    if most < atmosphere + LEAST_SUPPLY:
        raise RigError(
            f"a pressure limit of {most / 1e5:g} bar leaves nothing to choose; allow at least "
            f"{(atmosphere + LEAST_SUPPLY) / 1e5:.2f} bar, absolute"
        )
    if fixed.get("supply", atmosphere + LEAST_SUPPLY) < atmosphere + LEAST_SUPPLY:
        raise ScenarioError(
            f"--fix supply: {fixed['supply'] / 1e5:g} bar is less than {(atmosphere + LEAST_SUPPLY) / 1e5:.2f} bar, absolute"
        )
    if pressure_limit is None:
        most = max(most, fixed.get("supply", 0.0))
    if not own:  # more than the standards' rating is allowed on the owner's word
        allowed = tuple(replace(one, rating=max(one.rating, most)) for one in catalogue.cylinders)
        catalogue = replace(catalogue, cylinders=allowed)
    tank = rig.recovery.volume if rig.recovery is not None else 0.0
    _check_sense(fixed)
    space = Space(kinds, (atmosphere + LEAST_SUPPLY, most), reach, catalogue, tuple(sorted(fixed.items())), springs, tank, atmosphere)
    known = [*space.bounds, *(f"{kind.name}.bore" for kind in kinds)]
    for name, value in fixed.items():
        if name not in known:
            raise ScenarioError(f'--fix {name}: there is no such number to choose{nearest(name, known)}')
        kind = next((one for one in kinds if name == f"{one.name}.bore"), None)
        if kind is not None and not space.bores(kind):
            bores = ", ".join(f"{bore:g}" for bore in sorted({1e3 * one.bore for one in catalogue.cylinders}))
            raise ScenarioError(f"--fix {name}: the catalogue has no bore of {1e3 * value:g} mm; it has {bores} mm")
    return space


def _check_sense(fixed: Mapping[str, float]) -> None:
    """Refuse fixed numbers that no machine of this kind has.

    Raises:
        ScenarioError: an area, a distance or a pressure that is far too large.
    """
    for name, value in fixed.items():
        word = name.rpartition(".")[2]
        if word in _MOST and value > _MOST[word][0]:
            raise ScenarioError(f"--fix {name}: {_MOST[word][1].format(value)} no machine of this kind has; is the unit right?")


def _valves_for(rig: Rig, kinds: tuple[JointKind, ...], catalogue: Catalogue) -> tuple[CatalogueValve, ...]:
    """Return the catalogue's valves of the kind that the rig's cylinders have."""
    wanted = {"independent" if rig.cylinders[name].valve.independent else "4-way" for kind in kinds for name in kind.cylinders}
    if len(wanted) > 1 and catalogue.valves:
        raise RigError(f"{rig.path}: the cylinders to size have valves of both kinds: size them one after the other (--joints)")
    found = tuple(one for one in catalogue.valves if one.kind in wanted)
    if catalogue.valves and not found:
        kind = next(iter(wanted))
        raise RigError(
            f'{rig.path}: its valves are of kind = "{kind}", of which the catalogue has none; change the rig (or --valves) or the catalogue'
        )
    return found


def size(
    rig: Rig,
    conditions: tuple[Condition, ...],
    space: Space,
    trials: int,
    seed: int,
    workers: Workers,
    folder: Path,
    quiet: bool = True,
    tell: Callable[[str], None] = lambda words: None,
    disturbed: bool = False,
) -> Sizing:
    """Search, choose, write `sized.toml`, walk with it, and record that.

    Args:
        rig: The owner's machine.
        conditions: What it must do.
        space: What may be chosen.
        trials: Designs to look at.
        seed: Of all draws.
        workers: Who scores.
        folder: For `sized.toml`, `sized.rrd`, `sized.parquet` and the journals that a second start goes on from.
        quiet: No progress bar.
        tell: Takes a remark.
        disturbed: Whether the recommended design must also stand the disturbances of a walk (`sizing.disturbances`).

    Raises:
        ScenarioError: no design carries the loads.
        KeyboardInterrupt: with what was finished in the journal.
    """
    task = Task(rig, conditions, space, disturbed=disturbed)
    loads = tuple(joint_loads(rig, condition) for condition in conditions)
    joints = tuple(joint for kind in space.kinds for joint in kind.joints)
    journal = folder / "search.journal"
    outcome = search(task, trials, seed, workers, journal, quiet)
    _unless_interrupted(outcome)
    others = []
    for what, names in _present(rig):
        plain = replace(task, rig=replace(rig, effects=tuple(e for e in rig.effects if e.name not in names)))
        tell(f"searching again without {what}")
        beside = folder / f"search_without_{what.replace(' ', '_')}.journal"
        other = search(plain, trials, seed, workers, beside, quiet)
        _unless_interrupted(other)
        if other.front:
            others.append((what, plain, other, beside))
    if others:
        # each also judges the best of the rest, so that what differs is the physics and not the luck of a search
        fronts = [one for one in (outcome.front, *(other.front for _, _, other, _ in others)) if one]
        best = [one.numbers for front in fronts for one in shortlist(front, loads, joints).designs[:_SHARED]]
        outcome = with_more(task, outcome, best, seed, workers, journal)
        others = [
            (what, plain, with_more(plain, other, best, seed, workers, beside), beside) for what, plain, other, beside in others
        ]
    if not outcome.front:
        raise nothing_found(outcome, task)
    choice = recommended(outcome.front, loads, task, tell)
    design = choice.found.design
    chosen = fitted(rig, space.kinds, design)
    fine = mean_of([CoupledStride(rig, one, _FINE_STEP, _FINE_LEAD, joints).run(chosen) for one in conditions])
    with replacing(folder / "sized.toml") as new:
        new.write_text(sized_text(rig, space.kinds, design, folder), encoding="utf-8")
    _record(choice.confirmed, folder, seed)
    without = [
        Without(what, recommended(other.front, loads, plain), Evaluator(plain).judge(design))
        for what, plain, other, _ in others
    ]
    walks = any(condition.scenario.startswith("level_walk") for condition in conditions)
    published = published_class(rig, space) if walks else None
    tell("changing one number at a time")
    beside_it = sensitivity(task, outcome, choice.found, loads)
    walk = choice.confirmed.walk
    rods = rod_checks(walk) if walk is not None else ()
    bandwidths = force_bandwidths(walk, tuple(kind.cylinders[-1] for kind in space.kinds)) if walk is not None else ()
    motor, others_do = ankle_motor(rig, loads), left_alone(rig, kinds_left_alone(rig, space.kinds), loads, design.supply)
    return Sizing(task, loads, outcome, choice, fine, tuple(without), published, beside_it, rods, bandwidths, motor, others_do)


def _unless_interrupted(outcome: Outcome) -> None:
    if outcome.interrupted:
        raise KeyboardInterrupt(f"{len(outcome.trials)} designs are kept; the same command goes on from there")


def _present(rig: Rig) -> list[tuple[str, tuple[str, ...]]]:
    """Return the groups of effects that the rig has, and all of them together where there is more than one kind."""
    names = {effect.name for effect in rig.effects if not effect.of_valve}
    found = [(what, group) for what, group in GROUPS.items() if names & set(group)]
    if names and (len(found) != 1 or names - set(found[0][1])):
        found.append(("any effect", tuple(names)))
    return found


def _record(confirmed: Confirmed, folder: Path, seed: int) -> None:
    """Write table and recording of a walk with `sized.toml`."""
    from exo_sim.recording.rrd_file import write_rrd
    from exo_sim.recording.table_file import write_table
    from exo_sim.simulation import record

    if confirmed.walk is None:
        return
    table = record.recording(confirmed.walk, "sized", seed)
    write_table(folder / "sized.parquet", table)
    write_rrd(folder / "sized.rrd", table, scene=record.scene(confirmed.walk))
