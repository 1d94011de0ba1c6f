"""What the balance of forces of a joint may be asked, and the believed numbers that every fit of it may move."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exo_sim.diagnosis.fitting import FEWEST_ROWS, fit
from exo_sim.diagnosis.library import healthy_leaks
from exo_sim.diagnosis.motion_cut import MotionRun
from exo_sim.diagnosis.motion_problem import MotionProblem, stall_force
from exo_sim.diagnosis.quantity import Candidate, Quantity, Setting
from exo_sim.physics.effects.declaration import Effect, Parameter, declared

#: How far an owner's number of friction or spring may be off, one standard deviation, as a share.
KNOWN_SPREAD = 0.2
#: How far the damping of a joint may be below what its owner believes, as a share: a data sheet knows little of it.
DAMPING_SPREAD = 0.3
#: Damping is plainly too large where less than this share of it is left, and then no more than this of the squared error.
LEAST_DAMPED, LEAST_LEFT = 0.9, 0.8
#: What is the same as more damping, seen from the balance of forces.
LIKE_DAMPING = "viscous_friction"
#: What looks like less damping than believed: friction that falls as the speed grows.
LIKE_LESS_DAMPING = ("stribeck_friction",)
#: What a good pressure sensor's zero may be off by [Pa]: a constant force that no recording can call friction.
PRESSURE_OFFSET = 1200.0
#: Forces that a healthy cylinder loses besides, as shares of its stall force: dry friction (one standard deviation, and the most), and
#: a spring over its whole stroke.
HEALTHY_DRY, MOST_DRY, MOST_SPRING = 0.001, 0.002, 0.02
#: Only a dry contact softer than this is a finding [N/m]; any seal shows a stiffer one.
SOFT_CONTACT = 2.5e5


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
