"""The motion cut of one joint as a least-squares problem: numbers in, whitened missing force of the training time out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion

from exo_sim.diagnosis.fitting import FEWEST_ROWS, fit
from exo_sim.diagnosis.library import healthy_leaks
from exo_sim.diagnosis.motion_cut import MotionRun, as_smooth, resistance_along, smoothing
from exo_sim.diagnosis.quantity import Candidate, Quantity, Setting
from exo_sim.diagnosis.split import Split
from exo_sim.physics.effects.declaration import Effect, Parameter, declared

Array = NDArray[np.float64]

#: Balances are averaged over this time before they are compared [s].
GROUP = 0.02
#: Blocks of time that count as one witness [s].
BLOCK = 1.0
#: What a healthy machine's balance misses, as a share of the forces at work.
STRUCTURAL_SHARE = 0.008

#: ... and what no healthy machine's does, as a share of the same.
SICK_SHARE = 0.03
#: How far an owner's number of friction or spring may be off, one standard deviation, as a share.
KNOWN_SPREAD = 0.2
#: How far the damping of a joint may be below what its owner believes, as a share: a data sheet knows little of it.
DAMPING_SPREAD = 0.3
#: Damping is plainly too large where less than this share of it is left, and then no more than this of the squared error.
LEAST_DAMPED, LEAST_LEFT = 0.9, 0.8
#: What looks like less damping than believed: friction that falls as the speed grows.
LIKE_LESS_DAMPING = ("stribeck_friction",)
#: An effect that lowers the error by less than this share of the stall force is not worth a name.
MATERIAL_SHARE = 2e-4
#: What a good pressure sensor's zero may be off by [Pa]: a constant force that no recording can call friction.
PRESSURE_OFFSET = 1200.0

#: Forces that a healthy cylinder loses besides, as shares of its stall force: dry friction (one standard deviation, and the most),
#: a spring over its whole stroke, and all together what no name is looked for.
HEALTHY_DRY, MOST_DRY, MOST_SPRING, NAMELESS = 0.001, 0.002, 0.02, 0.003

#: Stiffness of a dry contact before it slides that any seal shows [N/m]; only one much softer is a finding.
HEALTHY_CONTACT, SOFT_CONTACT = 8e5, 2.5e5


class MotionProblem:
    """One joint, any number of runs.

    Args:
        runs: Balances of the joint.
        setting: The machine as believed; its cylinder record holds what resists the motion.
        split: Which time may be used.
        held_out: Judge the kept time instead.
    """

    def __init__(self, runs: Sequence[MotionRun], setting: Setting, split: Split, held_out: bool = False):
        self.runs, self.setting = list(runs), setting
        self.setting.cylinder["effective_mass"] = self.runs[0].effective_mass
        if not self.runs[0].turning and float(self.setting.cylinder["presliding"]["stiffness"][0]) == 0.0:
            self.setting = self.setting.copy()
            self.setting.cylinder["presliding"]["stiffness"] = HEALTHY_CONTACT
        self.setting.cylinder["turning"] = float(self.runs[0].turning and self.runs[0].cylinder is None)
        self.unit = "N*m" if self.runs[0].turning else "N"
        self._groups: list[NDArray[np.int64]] = []
        blocks, scales, offset = [], [], 0
        for run in self.runs:
            usable = split.held_out(run.recording, run.time) if held_out else split.training(run.recording, run.time)
            group, block, count = _layout(run, usable)
            self._groups.append(group)
            blocks.append(block + offset)
            offset += int(block.max()) + 1 if block.size else 0
            per_row = max(1.0, run.every * GROUP / max(float(np.median(np.diff(run.time))), 1e-9))
            # neighbouring samples share the smoothing window: averaging GROUP of it gains little
            force = run.drive + run.external
            size = float(np.std(force)) + float(np.std(run.inertial))
            scale = np.hypot(run.noise, STRUCTURAL_SHARE * size) if count.size else 0.0
            scales.append(
                np.full(len(count), max(scale, 1e-9) * np.sqrt(min(1.0, 3.0 / per_row) if per_row > 3 else 1.0))
            )
        self.blocks = np.concatenate(blocks) if blocks else np.zeros(0, int)
        self.scale = np.concatenate(scales) if scales else np.zeros(0)

    @property
    def size(self) -> int:
        """How many rows the residual has."""
        return int(self.blocks.size)

    @property
    def filled_in(self) -> bool:
        """Whether a pressure in it was not measured."""
        return any(run.filled_in for run in self.runs)

    @property
    def material(self) -> float:
        """Drop of the root-mean-square error that matters, in units of the whitened rows."""
        floor = MATERIAL_SHARE * stall_force(self.runs[0], self.setting)
        return floor / float(np.median(self.scale)) if self.scale.size else 0.0

    @property
    def sick(self) -> float:
        """Root-mean-square error beyond which no healthy machine's balance is, in units of the whitened rows."""
        force = max(
            (float(np.std(run.drive + run.external)) + float(np.std(run.inertial)) for run in self.runs), default=0.0
        )
        floor = max(SICK_SHARE * force, NAMELESS * stall_force(self.runs[0], self.setting))
        return floor / float(np.median(self.scale)) if self.scale.size else 0.0

    def apply(self, values: dict[Quantity, float], fixed: Sequence[tuple[Quantity, float]] = ()) -> Setting:
        """Return the setting with these numbers put in."""
        setting = self.setting.copy()
        for quantity, value in (*values.items(), *fixed):
            quantity.put(setting, value)
        return setting

    def missing(self, setting: Setting, index: int) -> Array:
        """Return the force that the balance lacks at every sample of a run [N or N m], shape (n,)."""
        run, sensors = self.runs[index], setting.sensors
        resisted = np.empty(len(run.time))
        resistance_along(setting.cylinder[0], run.time, run.position, run.velocity, run.gauge, resisted)
        resisted = as_smooth(run.time, run.arm * resisted)  # as the measured forces are: a reversal is a step on neither side
        mass = sensors.get("payload_mass", 1.0)
        moved = (
            run.inertial
            + (sensors.get("inertia", 1.0) - 1.0) * (run.inertial - run.bias)
            + sensors.get("zero", 0.0) * run.tilt
        )
        passive = run.passive if run.damped is None else run.passive + (sensors.get("damping", 1.0) - 1.0) * run.damped
        found = mass * moved - passive - run.drive - run.external + resisted - sensors.get("offset", 0.0)
        for column, lever in run.levers.items():
            found = found + lever * sensors.get(f"{column}.bias", 0.0)
        for name, answer in run.unsure.items():
            found = found - answer * sensors.get(name, 0.0)
        for name, answer in run.leaks.items():
            found = found - answer * float(setting.cylinder["external_leakage"][name][0])
        return found

    def residual(self, values: dict[Quantity, float], fixed: Sequence[tuple[Quantity, float]] = ()) -> Array:
        """Return the whitened missing force for these numbers, shape (size,)."""
        return self.residual_of(self.apply(values, fixed))

    def residual_of(self, setting: Setting) -> Array:
        """Return the whitened missing force of a setting, shape (size,)."""
        pieces = []
        for index, group in enumerate(self._groups):
            keep = group >= 0
            if keep.any():
                missing = self.missing(setting, index)
                pieces.append(np.bincount(group[keep], weights=missing[keep]) / np.bincount(group[keep]))
        return np.concatenate(pieces) / self.scale if pieces else np.zeros(0)


def _layout(run: MotionRun, usable: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """Return group of each sample (-1: not compared), block of each group and its count; samples at rest are not compared.

    At rest dry friction takes any value up to its level: the balance says nothing of it.
    """
    time = run.time
    step = float(np.median(np.diff(time)))
    size = max(1, int(round(GROUP / step)))
    edge = max(2, int(round(0.5 * smoothing(time) / step)))
    turned = np.diff(np.signbit(run.velocity), prepend=run.velocity[0] < 0.0)  # between two samples that both move
    moving = binary_erosion((np.abs(run.velocity) > run.still) & ~turned, iterations=edge)
    good = usable & moving & np.isfinite(run.inertial + run.drive + run.external)
    for begin in run.breaks:
        good[max(0, begin - edge) : begin + edge] = False
    good[-edge:] = False
    group = np.full(len(time), -1)
    blocks: list[int] = []
    counts: list[float] = []
    for first in range(0, len(time), size):
        chosen = np.arange(first, min(first + size, len(time)))
        if good[chosen].all():
            group[chosen] = len(counts)
            counts.append(float(chosen.size))
            blocks.append(int((time[first] - time[0]) / BLOCK))
    return group, np.array(blocks, dtype=int), np.array(counts)


def stall_force(run: MotionRun, setting: Setting) -> float:
    """Return what the cylinder of a balance can push at most [N, N m at the joint]; 0 without a cylinder."""
    if run.cylinder is None:
        return 0.0
    gauge = float(setting.world["supply_pressure"][0] - setting.world["atmosphere"][0])
    return max(gauge, 0.0) * float(setting.cylinder["area_1"][0]) * float(np.median(np.abs(run.arm)))


def believed(runs: Sequence[MotionRun], setting: Setting, where: str) -> tuple[Quantity, ...]:
    """Return the believed numbers that every fit of the balance may move: the mass, and an offset that nobody can exclude."""
    run = runs[0]
    lever = max((float(np.median(np.abs(v))) for k, v in run.levers.items() if "pressure" in k), default=0.0)
    force = float(np.std(run.drive + run.external)) or float(np.std(run.inertial)) or 1.0
    spread = max(PRESSURE_OFFSET * lever, 1e-4 * force)
    if run.cylinder is None and not run.external_recorded:
        spread = 0.02 * float(np.std(run.inertial))
    stall = stall_force(run, setting) / max(float(np.median(np.abs(run.arm))), 1e-9)
    found = []
    if run.weighs and (
        run.cylinder is not None or run.external_recorded
    ):  # a free swing scales with its mass: no recording of it holds the mass
        found.append(
            Quantity("payload_mass", run.joint, "payload_mass", "1", "sensor", 0.02, 0.2, 5.0, (1.0, 0.05), neutral=1.0)
        )
    unit = "N*m" if run.turning else "N"
    found.append(Quantity("offset", run.joint, "offset", unit, "sensor", max(spread, 1e-6), -1e6, 1e6, (0.0, spread)))
    if run.turning:
        found.append(Quantity("inertia", run.joint, "inertia", "1", "sensor", 0.01, 0.5, 2.0, (1.0, 0.05), neutral=1.0))
    if float(np.std(run.tilt)) > 0.0:
        found.append(Quantity("zero", run.joint, "zero", "rad", "sensor", 0.005, -0.3, 0.3, (0.0, 0.01)))
    for name in dict.fromkeys(name for run in runs for name in run.unsure):
        found.append(Quantity("filled_in", where, name, "1", "sensor", 1.0, -20.0, 20.0, (0.0, 1.0)))
    for name in run.leaks:
        spread, unit = healthy_leaks(setting)[name], declared()["external_leakage"].parameter(name).unit
        if unit == "m^2":  # one law will do for a trace
            found.append(Quantity("external_leakage", where, name, unit, "cylinder", spread, 0.0, 2.5 * spread, (0.0, spread)))
    for effect in declared().values():
        if (
            effect.cut != "motion"
            or effect.name not in (setting.cylinder.dtype.names or ())
            or effect.name == "presliding"
        ):
            continue
        if effect.name == "coulomb_friction" and stall > 0.0 and setting.cylinder[effect.name]["force"][0] == 0.0:
            found.append(
                Quantity(effect.name, where, "force", "N", "cylinder", HEALTHY_DRY * stall, 0.0, MOST_DRY * stall,
                         (0.0, HEALTHY_DRY * stall))
            )  # fmt: skip
        for parameter in effect.parameters:
            value = float(setting.cylinder[effect.name][parameter.name][0])
            if value != 0.0 and not parameter.choices:
                found.append(
                    Quantity(
                        effect.name,
                        where,
                        parameter.name,
                        parameter.unit_at(run.turning and run.cylinder is None),
                        "cylinder",
                        KNOWN_SPREAD * abs(value),
                        parameter.low,
                        parameter.high,
                        (value, KNOWN_SPREAD * abs(value)),
                    )  # fmt: skip
                )
    return tuple(found)


def overdamped(problem: MotionProblem, nuisances: tuple[Quantity, ...]) -> tuple[Quantity, ...]:
    """Return the believed numbers with the joint's damping among them where it is plainly too large; else as they were.

    Only then: damping that is free to move would hide viscous friction, which is the same with the opposite sign.
    """
    more = damping_freed(problem, nuisances)
    if not more:
        return nuisances
    damping = more[-1]
    fits = []
    for quantities in (nuisances, more):
        start = {q: q.prior[0] if q.prior else q.neutral for q in quantities}
        fits.append(fit(problem.residual, quantities, start, most=8))
    plain, freed = fits
    plainly = freed.values[damping] < LEAST_DAMPED and freed.sse < LEAST_LEFT * plain.sse
    return more if plainly else nuisances


def damping_freed(problem: MotionProblem, nuisances: tuple[Quantity, ...]) -> tuple[Quantity, ...]:
    """Return the believed numbers with the joint's damping among them, none where there is none or it is among them already."""
    run = problem.runs[0]
    if run.damped is None or problem.size < FEWEST_ROWS or any(q.effect == "joint_damping" for q in nuisances):
        return ()
    return (*nuisances, Quantity("joint_damping", run.joint, "damping", "1", "sensor", 0.1, 0.0, 1.0, (1.0, DAMPING_SPREAD), neutral=1.0))


def candidates(runs: Sequence[MotionRun], setting: Setting, where: str) -> tuple[Candidate, ...]:
    """Return every question that the balance of this joint can be asked."""
    run = runs[0]
    turning = run.turning and run.cylinder is None
    force = max(float(np.std(run.drive + run.external)), 0.1 * float(np.std(run.inertial)), 1e-6)
    speed = max(float(np.nanstd(run.velocity)), 1e-6)
    travel = max(float(np.nanstd(run.position)), 1e-6)
    stall = stall_force(run, setting) / max(float(np.median(np.abs(run.arm))), 1e-9)
    stroke = max(float(setting.cylinder["stroke"][0]), 1e-3)
    least = {("coulomb_friction", "force"): MOST_DRY * stall, ("return_spring", "stiffness"): MOST_SPRING * stall / stroke}
    pressure = max(float(np.mean(np.abs(run.gauge).sum(1))), 1.0)
    # a tenth of the forces at work, spread over the speeds, travels and pressures that were met
    sizes = {
        "N": 0.1 * force, "N s/m": 0.1 * force / speed, "N s^2/m^2": 0.1 * force / speed**2, "N/m": 0.1 * force / travel,
        "m": float(np.nanmean(run.position)), "m^2": 0.1 * force / pressure, "m/s": 0.1 * speed,
    }  # fmt: skip
    found: list[Candidate] = []
    for effect in declared().values():
        place = "cylinder" if run.cylinder is not None else "joint"
        if (
            effect.cut != "motion"
            or place not in effect.places
            or effect.name not in (setting.cylinder.dtype.names or ())
        ):
            continue
        if effect.name == "asymmetric_friction" and run.cylinder is None:
            continue  # while it moves, Coulomb friction with an offset says the same in simpler words
        if effect.name != "presliding" and setting.is_on(effect):
            continue
        for form in effect.asked.forms or (tuple(p.name for p in effect.parameters),):
            quantities, start = [], []
            for name in form:
                parameter = effect.parameter(name)
                size = _size(parameter, sizes)
                high = (
                    SOFT_CONTACT
                    if effect.name == "presliding" and name == "stiffness" and not run.turning
                    else parameter.high
                )
                scale = 5e4 if effect.name == "presliding" else abs(size) or 1.0
                quantities.append(
                    Quantity(
                        effect.name, where, name, parameter.unit_at(turning), "cylinder", scale, parameter.low, high,
                        least=least.get((effect.name, name), 0.0),
                    )  # fmt: skip
                )
                start.append(size)
            starts = [tuple(start)]
            if effect.name == "stribeck_friction":
                dry = float(setting.cylinder["coulomb_friction"]["force"][0])
                starts = [(b * dry + c * force, w * speed) for b, c in ((1.4, 0.1), (2.0, 0.4)) for w in (0.05, 0.25)]
            if effect.name == "presliding":
                starts = [(1e5,), (2e4,)]
            if effect.name == "return_spring":  # stiffness times rest is one number: a bad start for one of them traps the other
                middle = float(np.nanmean(run.position))
                starts = [(s * force / travel, middle + r * travel) for s in (0.2, 1.0) for r in (-4.0, -1.5, 0.0, 1.5, 4.0)]
            found.append(
                Candidate(effect.name, where, "+".join(form), tuple(quantities), tuple(starts),
                          proportional=effect.name not in ("stribeck_friction", "presliding", "return_spring"),
                          beside=_ground_that_lacks(effect, setting))
            )  # fmt: skip
    for name in run.leaks:
        healthy, leak = healthy_leaks(setting)[name], declared()["external_leakage"].parameter(name)
        hole = Quantity("external_leakage", where, name, leak.unit, "cylinder", 10.0 * healthy, 0.0, leak.high, least=healthy)
        found.append(Candidate("external_leakage", where, name, (hole,), ((10.0 * healthy,),), proportional=True))
    for column in run.levers:
        unit = "Pa" if "pressure" in column else ("N*m" if run.turning else "N")
        level = 0.02 * force / max(float(np.median(np.abs(run.levers[column]))), 1e-12)
        bias = Quantity("sensor_bias", column, f"{column}.bias", unit, "sensor", level, -1e7, 1e7)
        found.append(Candidate("sensor_bias", column, "value", (bias,), ((level,),), "sensor"))
    return tuple(found)


def _ground_that_lacks(effect: Effect, setting: Setting) -> str:
    """Return the effect that this one comes on top of, "" where it needs none or the rig has it."""
    base = effect.asked.on_top_of
    return "" if not base or setting.is_on(declared()[base]) else base


def _size(parameter: Parameter, sizes: dict[str, float]) -> float:
    return sizes.get(parameter.unit, 1.0)
