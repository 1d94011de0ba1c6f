"""Actuators for any machine that nobody wears, against a motion that it is to follow: bores, strokes, valves and supply.

Each design is screened by what its rods must do (`motion_loads`) and, where it can, made to follow the motion with its gas, as
`exo-sim run MOTION --rig RIG` does. Attachment points stay where the MJCF has them.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from exo_sim import progress
from exo_sim.errors import ExoSimError, RigError
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig, assembly
from exo_sim.rig.control_step import longest_step
from exo_sim.simulation.unworn import UnwornSimulation
from exo_sim.sizing.bought_parts import BoughtParts
from exo_sim.sizing.capability import Capability, capability, margin
from exo_sim.sizing.design import END_CLEARANCE, PLACES, valve_effects, with_effects
from exo_sim.sizing.design_space import MOST_ABOVE, VALVE_AREAS
from exo_sim.sizing.evaluation import AMPLE_MARGIN, ENOUGH_MARGIN
from exo_sim.sizing.motion_loads import RodLoads, rod_loads
from exo_sim.sizing.rod_space import RodSpace

#: Designs asked for together, NSGA-II's population.
_BATCH = 20
#: Part of a motion, and the most [s], in which the chambers fill and errors do not count.
_FILLING, _FILLING_TIME = 0.1, 1.0


@dataclass(frozen=True)
class RodDesign:
    """One design.

    Attributes:
        number: Of the trial.
        rig: The owner's with its numbers.
        parts: What is to be bought, by group.
        coldest: Of the gas in the chambers [K], by group; empty where it was not moved.
        margin: Least force in hand at the speed of the motion, as a share of the largest wanted.
        gas: Drawn over the motion [kg].
        mass: Of all cylinders [kg].
        error: Largest rms of the force error of a rod [N].
        position_error: Largest rms of the position error over the joints [m or rad].
        peak: Largest pressure in a chamber [Pa].
        fate: Why it cannot be had, or "".
    """

    number: int
    rig: Rig
    parts: Mapping[str, BoughtParts]
    margin: float
    gas: float = np.inf
    mass: float = np.inf
    error: float = np.inf
    position_error: float = np.inf
    peak: float = np.inf
    fate: str = ""
    coldest: Mapping[str, float] = field(default_factory=dict)

    @property
    def costs(self) -> tuple[float, float, float, float]:
        """What is to be small: less margin (ample is enough), gas, mass, error of position."""
        return -min(self.margin, AMPLE_MARGIN), self.gas, self.mass, self.position_error


class RodJudge:
    """Judges designs along one motion.

    Args:
        rig: The owner's machine.
        recording: The motion.
        space: What may be chosen.
        loads: What the rods must do.

    Attributes:
        links: Which joint each cylinder drives.
    """

    def __init__(self, rig: Rig, recording: Recording, space: RodSpace, loads: RodLoads):
        self.rig, self._recording, self.space, self.loads = rig, recording, space, loads
        self.links = linkages(rig, load(rig))
        self._index = {name: i for i, name in enumerate(rig.cylinders)}

    def bounds(self) -> dict[str, tuple[float, float]]:
        """Return the bounds of the continuous variables, by name."""
        valves = self.space.catalogue.valves
        areas = (valves[0].area, valves[-1].area) if valves else VALVE_AREAS
        out = {"supply": self.space.supply, **{f"{name}.valve": areas for name in self.space.groups}}
        return {name: (self.space.fixed[name],) * 2 if name in self.space.fixed else ends for name, ends in out.items()}

    def judge(self, numbers: Mapping[str, float], number: int) -> RodDesign:
        """Return the design that a set of variables stands for: supply, and by group "above" (bores above the smallest) and "valve"."""
        supply = float(np.round(numbers["supply"] / PLACES["pressure"])) * PLACES["pressure"]
        rig = replace(self.rig, supply=replace(self.rig.supply, pressure=supply))
        parts: dict[str, BoughtParts] = {}
        mass, least = 0.0, float(np.inf)
        for group, names in self.space.groups.items():
            chosen = self._chosen(rig, group, names, numbers)
            if chosen is None:
                return RodDesign(number, rig, parts, -1.0, fate=f"{group}: no cylinder of the catalogue has the stroke or bears the supply")
            rig, part, held, weight = chosen
            parts[group], mass, least = part, mass + weight, min(least, held)
        if least < 0.0:
            return RodDesign(number, rig, parts, least, mass=mass, fate="too weak for the motion")
        if any(longest_step(rig, rig.cylinders[name]) < self._step for names in self.space.groups.values() for name in names):
            return RodDesign(number, rig, parts, least, mass=mass, fate="its valve settles a chamber within the time step of the MJCF")
        try:
            run = UnwornSimulation(rig, self._recording).run()
        except ExoSimError as error:
            return RodDesign(number, rig, parts, least, mass=mass, fate=str(error))
        first = min(int(_FILLING * len(run.time)), int(_FILLING_TIME / self._step))

        def rms(key: str, wanted: str) -> float:
            return float(np.sqrt(np.mean((run.columns[key][first:] - run.columns[wanted][first:]) ** 2)))

        peak = max(float(run.columns[f"{name}.pressure_{side}"].max()) for name in rig.cylinders for side in (1, 2))
        limit = min((one.rating for one in rig.cylinders.values() if one.rating is not None), default=self.space.supply[1])
        return RodDesign(
            number, rig, parts, least, gas=sum(float(np.ptp(run.columns[f"{name}.gas_used"])) for name in rig.cylinders), mass=mass,
            error=max(rms(f"{name}.force", f"{name}.force_demanded") for name in rig.cylinders),
            position_error=max(rms(f"{joint}.position", f"{joint}.position_demanded") for joint in run.motion.joints), peak=peak,
            fate=f"{peak / 1e5:.1f} bar in a chamber, {limit / 1e5:.1f} allowed" if peak > limit * 1.0001 else "",
            coldest={
                group: min(float(run.columns[f"{name}.temperature_{side}"].min()) for name in names for side in (1, 2))
                for group, names in self.space.groups.items()
            },
        )  # fmt: skip

    @property
    def _step(self) -> float:
        return float(self.loads.motion.time[1] - self.loads.motion.time[0])

    def _chosen(
        self, rig: Rig, group: str, names: tuple[str, ...], numbers: Mapping[str, float]
    ) -> tuple[Rig, BoughtParts, float, float] | None:
        """Return the rig with a group's cylinders, what they are called, their margin and mass; None where none can be had."""
        at = [self._index[name] for name in names]
        span = self.loads.span[at]
        travel = float(np.max(span[:, 1] - span[:, 0])) + 2 * END_CLEARANCE + PLACES["length"]
        area, valves = float(np.round(numbers[f"{group}.valve"] / PLACES["area"])) * PLACES["area"], self.space.catalogue.valves
        valve = min(valves, key=lambda one: abs(np.log(one.area / numbers[f"{group}.valve"])), default=None)
        if valve is not None:
            area = valve.area
            said = [(name, {parameter: value}) for name, parameter, value in valve_effects(valve)]
            rig = replace(rig, effects=with_effects(rig.effects, names, said))
        wanted = self.space.fixed.get(f"{group}.bore")
        found = []
        for entry in self.space.catalogue.cylinders:
            stroke = entry.stroke_for(travel)
            fits = wanted is None or abs(entry.bore - wanted) < 1e-6
            if stroke is None or not fits or rig.supply.pressure > entry.rating * 1.0001:
                continue
            cylinders = dict(rig.cylinders)
            dead_1, dead_2 = entry.dead_volumes()
            for name, low in zip(names, span[:, 0]):
                cylinders[name] = replace(
                    cylinders[name], bore=entry.bore, rod=entry.rod, stroke=stroke, dead_volume_1=dead_1, dead_volume_2=dead_2,
                    retracted_length=float(np.floor((low - END_CLEARANCE) / PLACES["length"]) * PLACES["length"]), valve_area=area,
                    rating=entry.rating,
                )  # fmt: skip
            candidate = replace(rig, cylinders=cylinders)
            held = min(self._margin(candidate, name) for name in names)
            mass = entry.mass(stroke) + (valve.mass if valve is not None else 0.0)
            found.append((candidate, BoughtParts(group, entry, valve), held, len(names) * mass))
        if not found:
            return None
        enough = next((i for i, one in enumerate(found) if one[2] >= ENOUGH_MARGIN), int(np.argmax([one[2] for one in found])))
        return found[min(enough + int(numbers.get(f"{group}.above", 0)), len(found) - 1)]

    def envelope(self, rig: Rig, name: str) -> tuple[Capability, NDArray[np.float64]]:
        """Return what a cylinder of a rig can do along the motion, forces in place of torques, and what is wanted of it, shape (n,) [N]."""
        i = self._index[name]
        record, ones = assembly.cylinders(rig)[i], np.ones(len(self.loads.force))
        length, speed, force = (np.ascontiguousarray(each[:, i]) for each in (self.loads.length, self.loads.speed, self.loads.force))
        found = capability(assembly.world(rig)[0], record, ones, length, rig.cylinders[name].retracted_length, speed)
        return found, force

    def _margin(self, rig: Rig, name: str) -> float:
        """Return the least force in hand of a cylinder along the motion, as a share of the largest wanted."""
        found, force = self.envelope(rig, name)
        return margin(np.minimum(found.slack(force), found.still_slack(force)), force)


def search(judge: RodJudge, trials: int, seed: int, quiet: bool = True) -> list[RodDesign]:
    """Return all designs of a search by Optuna's NSGA-II, in their order; the first is the owner's, as near as the catalogue has it."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        sampler = optuna.samplers.NSGAIISampler(seed=seed, population_size=_BATCH)
    study = optuna.create_study(directions=["minimize"] * 4, sampler=sampler)
    distributions: dict[str, optuna.distributions.BaseDistribution] = {
        name: optuna.distributions.FloatDistribution(low, high, log=name.endswith(".valve")) for name, (low, high) in judge.bounds().items()
    }
    for group in judge.space.groups:
        distributions[f"{group}.above"] = optuna.distributions.IntDistribution(0, MOST_ABOVE)
    own = {"supply": judge.rig.supply.pressure, **{f"{group}.above": 0 for group in judge.space.groups}}
    own |= {f"{group}.valve": judge.rig.cylinders[names[0]].valve_area for group, names in judge.space.groups.items()}
    study.enqueue_trial({name: float(np.clip(own[name], *ends)) for name, ends in judge.bounds().items()} | {
        f"{group}.above": 0 for group in judge.space.groups
    })  # fmt: skip
    out = []
    with progress.Bar(trials, "sizing", unit="design", quiet=quiet) as bar:
        for number in range(trials):
            trial = study.ask(distributions)
            found = judge.judge(trial.params, number)
            trial.set_constraint("fate", 1.0 if found.fate else 0.0)
            study.tell(trial, [float(np.nan_to_num(cost, posinf=1e6)) for cost in found.costs])
            out.append(found)
            bar.advance()
    return out


def front_of(found: list[RodDesign]) -> list[RodDesign]:
    """Return the designs that can be had and that no other equals or betters in everything, by falling margin."""
    good = [one for one in found if not one.fate]
    costs = np.array([one.costs for one in good]).reshape(len(good), 4)

    def stays(i: int) -> bool:
        better = np.all(costs <= costs[i], axis=1) & np.any(costs < costs[i], axis=1)
        return not better.any() and not np.all(costs[:i] == costs[i], axis=1).any()

    keep = [one for i, one in enumerate(good) if stays(i)]
    return sorted(keep, key=lambda one: (-one.margin, one.gas, one.number))


def recommended(front: list[RodDesign]) -> RodDesign:
    """Return the design with enough margin, an error of position within a quarter of the best, and the least gas and mass together."""
    strong = [one for one in front if one.margin >= ENOUGH_MARGIN] or front
    best = min(one.position_error for one in strong)
    good = [one for one in strong if one.position_error <= 1.25 * best]
    gas, mass = min(one.gas for one in good) or 1.0, min(one.mass for one in good) or 1.0
    return min(good, key=lambda one: (one.gas / gas + one.mass / mass, one.number))


def loads_of(rig: Rig, recording: Recording) -> RodLoads:
    """Return `motion_loads.rod_loads` of a machine that has cylinders to size.

    Raises:
        RigError: it has none.
    """
    if not rig.cylinders:
        raise RigError(f"{rig.path}: there is no cylinder to size; give the rig a [cylinders.NAME] table")
    return rod_loads(rig, recording)
