"""Candidates for a balance of forces: every declared effect on motion, a leak of a chamber that nobody measured, and sensor offsets."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.estimation.sensor_error import sensor_error
from exo_sim.diagnosis.policy import healthy, priors
from exo_sim.diagnosis.subsystems.healthy_leak import OUTWARD, external_leaks
from exo_sim.diagnosis.subsystems.motion.full_scale import full_force, full_travel
from exo_sim.physics.declaration import Effect, declared
from exo_sim.physics.effects import friction_smoothing, presliding, sensor_bias
from exo_sim.physics.identification import ObservedMotion


def candidates(
    runs: Sequence[MotionRun], plant: PlantParameters, where: str, resolved: float = 0.0, creeps_below: float = math.inf
) -> tuple[Candidate, ...]:
    """Return every candidate that the balance of this joint or rod can show.

    Args:
        runs: The balances.
        plant: The nominal machine.
        where: The cylinder or joint that what resists belongs to.
        resolved: Speed from which on a law of speed shows [m/s or rad/s].
        creeps_below: A contact that rests until it breaks loose has its dry friction at this speed [m/s or rad/s].
    """
    run = runs[0]
    turning = run.turning and run.cylinder is None
    position, velocity = run.kinematics.position, run.kinematics.velocity
    force = max(float(np.std(run.driving)), 0.1 * float(np.std(run.inertia.force)), 1e-6)
    speed = max(float(np.nanstd(velocity)), 1e-6)
    travel = max(float(np.nanstd(position)), 1e-6)
    full = full_force(run, plant) / run.drive.usual_arm
    near, far = full_travel(run, plant)
    length = max(far - near, 1e-3)
    resistance = {"N": healthy.DRY_FRICTION * full, "N/m": healthy.SPRING * full / length}  # of a healthy machine
    pressure = max(float(np.mean(np.abs(run.drive.gauge).sum(1))), 1.0)
    # a tenth of the forces that act, spread over the speeds, travels and pressures that occurred
    moving = np.abs(velocity[np.abs(velocity) > run.kinematics.still])
    slowest, fastest = np.percentile(moving, [1.0, 99.0]).tolist() if moving.size else (0.0, np.inf)
    slowest = max(slowest, resolved)
    sizes = {
        "N": 0.1 * force, "N s/m": 0.1 * force / speed, "N s^2/m^2": 0.1 * force / speed**2, "N/m": 0.1 * force / travel,
        "m": float(np.nanmean(position)), "m^2": 0.1 * force / pressure, "m/s": 0.1 * speed,
    }  # fmt: skip
    found: list[Candidate] = []
    contained = plant.contained_effects
    for effect in declared().values():
        place, asked = "cylinder" if run.cylinder is not None else "joint", effect.identification
        if effect.cut != "motion" or asked.excluded:
            continue
        if place not in (asked.applicability.places or effect.places) or effect.name not in (plant.cylinder.dtype.names or ()):
            continue
        if (plant.is_on(effect) and not asked.though_on) or effect.name in contained:
            continue
        for form in asked.forms or (tuple(p.name for p in effect.parameters),):
            parameters, start = [], []
            for name in form:
                parameter = effect.parameter(name)
                size = sizes.get(parameter.unit, 1.0)
                low, high = parameter.low, parameter.high
                if name in asked.within_travels:
                    low, high = max(low, near - priors.REST_BEYOND * length), min(high, far + priors.REST_BEYOND * length)
                if name in asked.within_speeds:
                    low = min(max(low, 0.5 * slowest), high)
                    high = max(min(high, 0.25 * fastest), low)
                if name == asked.every_contact and not run.turning:
                    high = healthy.SOFT_CONTACT
                parameters.append(
                    FreeParameter(
                        effect.name,
                        where,
                        name,
                        parameter.unit_at(turning),
                        Target.CYLINDER,
                        asked.scale or abs(size) or 1.0,
                        low,
                        high,
                        asked.known.get(name),
                        healthy_limit=asked.resists * resistance.get(parameter.unit, 0.0),
                    )  # fmt: skip
                )
                start.append(size)
            starts = asked.starts or (tuple(start),)
            if asked.starts_by_motion is not None:
                seen = ObservedMotion(force, speed, travel, float(np.nanmean(position)), _nominal_base(effect, plant))
                starts = tuple(start[: len(form)] for start in asked.starts_by_motion(seen))
            found.append(
                Candidate(effect.name, where, "+".join(form), tuple(parameters), starts, fixed=_taken_in(effect, plant, where),
                          prerequisite=_missing_prerequisite(effect, plant), prevalence=asked.prevalence)
            )  # fmt: skip
    found += _contact_laws(plant, where, turning, run.cylinder is None, creeps_below)
    for name in run.imputed.leaks if run.imputed is not None else ():
        trace, leak = external_leaks(plant)[name], OUTWARD.parameter(name)
        hole = FreeParameter(OUTWARD.name, where, name, leak.unit, Target.CYLINDER, 10.0 * trace, 0.0, leak.high, healthy_limit=trace)
        found.append(Candidate(OUTWARD.name, where, name, (hole,), ((10.0 * trace,),), proportional=True))
    for column, lever in run.drive.levers.items() if run.imputed is None else ():  # an imputed chamber may do what a bias does
        unit = "Pa" if "pressure" in column else ("N*m" if run.turning else "N")
        level = 0.02 * force / max(float(np.median(np.abs(lever))), 1e-12)
        limit = healthy.ZEROS * priors.PRESSURE_ZERO if unit == "Pa" else healthy.CELL_ZERO * force
        zero = sensor_error(sensor_bias.EFFECT, column, f"{column}.bias", unit, level, (-1e7, 1e7), limit)
        found.append(replace(zero, prevalence=priors.FAULTY_ZERO))
    return tuple(found)


def creeps_at(values: Mapping[FreeParameter, float]) -> dict[FreeParameter, float]:
    """Return the speed at which dry friction has built up by what was fitted [m/s or rad/s]; nothing where it is there at once."""
    return {q: value for q, value in values.items() if q.effect == friction_smoothing.EFFECT.name and value > 0.0}


def _contact_laws(plant: PlantParameters, where: str, turning: bool, at_joint: bool, creeps_below: float) -> list[Candidate]:
    """Return the other ways in which dry friction may be written near rest, none of which is a finding."""
    return [*_firm_contact(plant, where, turning), *_creeping_contact(plant, where, turning, at_joint, creeps_below)]


def _firm_contact(plant: PlantParameters, where: str, turning: bool) -> list[Candidate]:
    """Return a contact that is softer than one that slides at once, and no softer than any seal's."""
    effect = presliding.EFFECT
    if turning or float(plant.cylinder[effect.name]["stiffness"][0]) < healthy.STIFF_CONTACT:
        return []
    stiffness = FreeParameter(
        effect.name, where, "stiffness", "N/m", Target.CYLINDER, effect.identification.scale, healthy.SOFT_CONTACT, healthy.STIFF_CONTACT
    )  # fmt: skip
    return [Candidate(effect.name, where, "firm", (stiffness,), ((4e5,),), proportional=False, is_law=True, prevalence=0.5)]


def _creeping_contact(plant: PlantParameters, where: str, turning: bool, at_joint: bool, creeps_below: float) -> list[Candidate]:
    """Return dry friction that builds up with speed instead of with travel: by `creeps_below` at the latest."""
    effect = friction_smoothing.EFFECT
    stiffness = float(plant.cylinder[presliding.EFFECT.name]["stiffness"][0])
    if plant.is_on(effect) or 0.0 < stiffness < healthy.STIFF_CONTACT:
        return []
    velocity = effect.parameter("velocity")
    if creeps_below <= velocity.low:
        return []
    high = min(velocity.high, creeps_below)
    parameter = FreeParameter(
        effect.name, where, "velocity", velocity.unit_at(turning and at_joint), Target.CYLINDER, 1e-3, velocity.low, high,
        (0.0, velocity.typical[1]),
    )  # fmt: skip
    return [Candidate(effect.name, where, "velocity", (parameter,), ((min(1e-3, high),),), proportional=False, is_law=True)]


def _taken_in(effect: Effect, plant: PlantParameters, where: str) -> tuple[tuple[FreeParameter, float], ...]:
    """Return what an effect takes the place of where the rig has it, the poorer form, as none: its own numbers are then the whole."""
    poorer = [(name, its) for name, shares in effect.absorbs if plant.is_on(declared()[name]) for its in dict(shares).values()]
    return tuple(
        (FreeParameter(name, where, its, declared()[name].parameter(its).unit, Target.CYLINDER, 1.0, 0.0, 0.0), 0.0)
        for name, its in dict.fromkeys(poorer)
    )


def _nominal_base(effect: Effect, plant: PlantParameters) -> float:
    """Return the nominal size of what an effect comes on top of; 0 where it comes on top of nothing."""
    base = effect.identification.on_top_of
    return float(plant.cylinder[base][declared()[base].parameters[0].name][0]) if base else 0.0


def _missing_prerequisite(effect: Effect, plant: PlantParameters) -> str:
    """Return the effect that this one comes on top of, "" where it needs none or the rig has it, in this form or a richer one."""
    base = effect.identification.on_top_of
    return "" if not base or plant.is_on(declared()[base]) or base in plant.contained_effects else base
