"""One division of the time: every cut of the plant searched and judged, and held against what was kept back."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from exo_sim.diagnosis import library, motion_library, supply_cut
from exo_sim.diagnosis.cases import Case, put_right, turned_round
from exo_sim.diagnosis.chamber_pressure import carried_over
from exo_sim.diagnosis.filled_in import begun_by_forces, filled_in
from exo_sim.diagnosis.fitted_set import Found, Trial
from exo_sim.diagnosis.fitting import FEWEST_ROWS
from exo_sim.diagnosis.gas_problem import GasProblem
from exo_sim.diagnosis.judging import AS_GOOD, Judged, judge
from exo_sim.diagnosis.motion_problem import MotionProblem
from exo_sim.diagnosis.nameless import pattern_left
from exo_sim.diagnosis.proof import Proof, prove
from exo_sim.diagnosis.quantity import Candidate, Quantity, Setting
from exo_sim.diagnosis.result import OpenQuestion
from exo_sim.diagnosis.search import Search
from exo_sim.diagnosis.set_fits import SetFits
from exo_sim.diagnosis.split import Split
from exo_sim.diagnosis.threads import Threads
from exo_sim.diagnosis.verdict import Unnamed, setting_of, unknown_findings
from exo_sim.physics.effects.declaration import declared
from exo_sim.physics.records import CYLINDER
from exo_sim.physics.transmission import gives
from exo_sim.rig import assembly

#: A valve command whose opposite leaves less than this share of the squared error is wired the wrong way round.
TURNED = 0.1

#: So few samples cost little to predict: every question is then fitted whole.
FEW_SAMPLES = 5000

#: Names of a transmission that gives.
SOFT = ("backlash", "transmission_compliance")

#: Damping believed too large is plain beside what was found where less of it gains so much (log-likelihood).
PLAINLY_LESS = 20.0

#: How a joint's number becomes its piston's: with which power of the lever between them.
_LEVERS = {"N": -1, "N s/m": -2, "N s^2/m^2": -3, "N/m": -2, "m": 1, "m/s": 1}

Progress = Callable[[str], None]
#: Effect and place that the check does not bear out, and why.
Doubts = dict[tuple[str, str], str]
#: By cylinder, numbers of what resists its piston.
Felt = Mapping[str, Sequence[tuple[Quantity, float]]]


@dataclass
class Examined:
    """What came out of one division of the time; `check` is what the time between fit and proof says of it, None where there is none."""

    case: Case
    parts: Split
    judged: list[Judged]
    nameless: list[Unnamed]
    proof: Proof
    check: Proof | None
    doubted: Doubts

    @property
    def surprise(self) -> float:
        """How much worse the check is met than the time of the fit; infinite where nothing in it could be compared."""
        if self.check is None:
            return 0.0
        return self.check.surprise if self.check.signals else math.inf


def examine(gathered: Case, parts: Split, doubted: Doubts, threads: Threads, say: Progress) -> Examined:
    """Search and judge every cut of the plant on one division of the time, and hold what comes out against what was kept back.

    Where a transmission gives, the piston's friction decides where the piston is, and so how large the chambers are: as soon as that
    is found the forces are asked, and the gas is judged once more with the friction that their balance found.
    """
    case = gathered.copy()
    judged = _cut(case, parts, doubted, None, threads, say)
    felt = _felt(judged)
    if felt or any(not one.empty and one.found.halted for one in judged):
        say("judging the gas once more, knowing what its forces say")
        case = gathered.copy()
        judged = _cut(case, parts, doubted, felt, threads, say)
    nameless = unknown_findings(_nameable(judged, case))
    say("proving on time kept back")
    check = prove(judged, case, parts.checking(), nameless) if parts.check else None
    return Examined(case, parts, judged, nameless, prove(judged, case, parts, nameless), check, doubted)


def _cut(case: Case, parts: Split, doubted: Doubts, felt: Felt | None, threads: Threads, say: Progress) -> list[Judged]:
    """Search and judge the gas, the supply and the forces, in this order; the case's pressures are put right in between.

    Without `felt` the search of the gas ends at a transmission that gives where there are forces to ask.
    """
    gas = _gas(case, parts, doubted, felt, threads, say)
    filled_in(case, gas, parts)
    put_right(case, carried_over(case, gas, parts))
    return _shared_once([*gas, *_supply(case, parts, gas, doubted, threads, say), *_motion(case, parts, doubted, threads, say)])


def _felt(judged: Sequence[Judged]) -> dict[str, list[tuple[Quantity, float]]]:
    """Return, by cylinder, what resists a piston behind a transmission that gives, where a balance of forces found any of it."""
    soft = {one.where for one in judged if isinstance(one.problem, GasProblem) and gives(setting_of(one, one.found.end).cylinder[0])}
    found = {}
    for one in judged:
        if one.cut == "motion" and one.where in soft and not one.nameless and any(c.kind == "missing_physics" for c in one.named):
            numbers = [*one.trial.fit.values.items(), *one.trial.fixed]
            found[one.where] = [(quantity, value) for quantity, value in numbers if quantity.target == "cylinder"]
    return found


def _asked(questions: Sequence[Candidate], doubted: Doubts) -> tuple[Candidate, ...]:
    """Return the questions that the check has not answered with no."""
    return tuple(question for question in questions if (question.effect, question.where) not in doubted)


def _told(say: Progress, part: str) -> Progress:
    """Return a progress that names the part it speaks of."""
    return lambda words: say(f"{part}: {words}")


def _gas(case: Case, parts: Split, doubted: Doubts, felt: Felt | None, threads: Threads, say: Progress) -> list[Judged]:
    found = []
    for name in list(case.cylinders):
        runs = case.cylinders[name] = [begun_by_forces(case, run) for run in case.cylinders[name]]
        joint = case.joint_of(name)
        index = list(case.rig.cylinders).index(name)
        drives = {link.cylinder: link.joint for link in case.links}
        believed = Setting(assembly.world(case.rig), assembly.cylinders(case.rig, drives)[index : index + 1])
        setting = library.without_what_was_measured(believed, runs)
        for quantity, value in (felt or {}).get(name, ()):
            quantity.put(setting, value)
        problem = GasProblem(runs, setting, parts)
        turned = GasProblem([replace(run, command=-run.command) for run in runs], setting, parts)
        if problem.size >= FEWEST_ROWS and np.sum(turned.residual({}) ** 2) < TURNED * np.sum(problem.residual({}) ** 2):
            problem, case.cylinders[name] = turned, turned.all_runs
            case.sensors.append(turned_round(name))
        commanded = any(run.commanded for run in runs)
        sides = [side for side in (1, 2) if any(run.pressure[side - 1] is not None for run in runs)]
        still = all(run.rests for run in runs)
        nuisances = library.believed(setting, name, commanded, sides, still) + library.known_effects(setting, name)
        questions = library.candidates(setting, runs, name, joint)
        if problem.size >= FEWEST_ROWS:
            problem = problem.either_law(nuisances, threads)
        search = Search(
            problem,
            nuisances,
            _asked(questions, doubted),
            threads,
            _told(say, name),
            cheap=sum(len(run.time) for run in runs) < FEW_SAMPLES,
            material=problem.material,
            until=_softens if felt is None and joint in case.joints else None,
        )
        found.append(judge("gas", name, problem, search.sets, search.run(), partial(pattern_left, problem)))
    return found


def _softens(trial: Trial) -> bool:
    return any(candidate.effect in SOFT for candidate in trial.chosen)


def _supply(case: Case, parts: Split, gas: Sequence[Judged], doubted: Doubts, threads: Threads, say: Progress) -> list[Judged]:
    """Judge the measured supply by what all cylinders together drew from it; nothing where one of them is not known."""
    if len(gas) < len(case.rig.cylinders) or any(one.empty for one in gas):
        return []
    drawn: dict[str, np.ndarray] = {}
    measured: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    feeds: dict[str, int] = {}
    for one in gas:
        whole = GasProblem(case.cylinders[one.where], setting_of(one, one.trial), parts, held_out=True)
        for index, run in enumerate(whole.runs):
            table = case.table(run.recording)
            if run.supply is None or "supply.pressure" not in table or len(run.time) != len(table.time):
                continue  # a run that was cut short does not say what its cylinder drew before
            drawn[run.recording] = drawn.get(run.recording, 0.0) + whole.predict(whole.setting, index).drawn
            measured[run.recording] = (run.time, table["supply.pressure"])
            feeds[run.recording] = feeds.get(run.recording, 0) + 1
    drawn = {name: flow for name, flow in drawn.items() if feeds[name] == len(case.rig.cylinders)}
    if not drawn:
        return []
    setting = Setting(assembly.world(case.rig), assembly.cylinders(case.rig)[:1])
    runs = [supply_cut.supply_run(name, *measured[name], drawn[name]) for name in drawn]
    problem = supply_cut.SupplyProblem(runs, setting, parts)
    search = Search(
        problem,
        supply_cut.believed(setting),
        _asked(supply_cut.candidates(setting), doubted),
        threads,
        _told(say, "supply"),
        cheap=True,
        material=problem.material,
    )
    return [judge("supply", "supply", problem, search.sets, search.run(), partial(pattern_left, problem))]


def _motion(case: Case, parts: Split, doubted: Doubts, threads: Threads, say: Progress) -> list[Judged]:
    found = []
    for joint, runs in case.joints.items():
        cylinder = runs[0].cylinder
        if cylinder is not None:
            index = list(case.rig.cylinders).index(cylinder)
            record = assembly.cylinders(case.rig)[index : index + 1]
        else:
            record = np.zeros(1, CYLINDER)
        _carry_over(case, joint, record, 1.0 if cylinder is None else float(np.median(np.abs(runs[0].arm))))
        where = cylinder or joint
        setting = Setting(assembly.world(case.rig), record)
        problem = MotionProblem(runs, setting, parts)
        nuisances = motion_library.overdamped(problem, motion_library.believed(runs, setting, where))
        asked = _asked(motion_library.candidates(runs, problem.setting, where), doubted)
        sought = partial(Search, library=asked, threads=threads, progress=_told(say, joint), cheap=True, material=problem.material)
        search = sought(problem, nuisances)
        outcome = search.run()
        freed = motion_library.damping_freed(problem, nuisances)
        if freed and _may_be_damping(outcome, SetFits(problem, freed, threads, cheap=True)):
            other = sought(problem, freed)
            anew = other.run()
            more = anew.end.numbers - outcome.end.numbers
            if more <= 0 and other.sets.loses(anew.end, outcome.end) < (AS_GOOD if more < 0 else -PLAINLY_LESS):
                search, outcome = other, anew
        found.append(judge("motion", where, problem, search.sets, outcome, partial(pattern_left, problem)))
    return found


def _may_be_damping(outcome: Found, freed: SetFits) -> bool:
    """Say whether less damping than believed may stand behind what was found: it looks like that, or less of it gains plainly."""
    chosen = outcome.end.chosen
    named = {one.effect for one in chosen}
    if named & set(motion_library.LIKE_LESS_DAMPING):
        return True
    if not chosen or motion_library.LIKE_DAMPING in named:
        return False
    return freed.loses(freed.try_set(chosen, outcome.end), outcome.end) < -PLAINLY_LESS


def has_filled_in(one: Judged) -> bool:
    """Say whether it is a balance of forces one of whose pressures was not measured."""
    return isinstance(one.problem, MotionProblem) and one.problem.filled_in


def leave_open(one: Judged, case: Case) -> None:
    """Make an open question of what is left in a balance of forces one of whose pressures was filled in."""
    why = "it does not close, and one of its pressures was not recorded: the chamber may be at fault"
    case.open.append(OpenQuestion(f"the rest of the balance of forces of {one.where}", ("friction, load and joint effects",), why))
    one.nameless, one.unclosed = False, True


def _nameable(judged: list[Judged], case: Case) -> list[Judged]:
    """Take back what has no name in a balance of forces whose transmission was found to give, or one of whose pressures was filled in.

    The balance takes the one for rigid; of the other nobody knows what the unmeasured chamber does.
    """
    soft = {f.where for one in judged for f in one.findings if f.name in SOFT}
    for one in judged:
        if one.cut != "motion" or not one.nameless:
            continue
        if has_filled_in(one):
            leave_open(one, case)
        one.nameless = one.nameless and one.where not in soft
    return judged


def _carry_over(case: Case, joint: str, record: np.ndarray, arm: float) -> None:
    """Add what the rig says of the joint's own friction and springs to the record that the balance is judged with.

    A piston feels them through its lever `arm` [m/rad, or 1].
    """
    for effect in case.rig.effects:
        if effect.where == joint and effect.name in (record.dtype.names or ()):
            for name, value in effect.parameters.items():
                unit = declared()[effect.name].parameter(name).unit
                record[effect.name][name] += value * arm ** _LEVERS.get(unit, 0)


def _shared_once(judged: list[Judged]) -> list[Judged]:
    """Keep an effect of the shared supply or exhaust where it is seen best, and only there."""
    best: dict[tuple[str, str], tuple[float, int]] = {}
    for index, one in enumerate(judged):
        for finding in one.findings:
            key = finding.name, finding.where
            if key not in best or finding.log10_odds > best[key][0]:
                best[key] = finding.log10_odds, index
    for index, one in enumerate(judged):
        one.findings[:] = [f for f in one.findings if best[f.name, f.where][1] == index]
    return judged
