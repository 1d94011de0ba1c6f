"""Nuisance parameters of a balance of forces: masses, zeros and offsets that nobody can exclude, free in every fit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exo_sim.conventions.undriven import drives
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.estimation.least_squares import fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.nominal_numbers import DRIVE_DELAY, FORCE_OFFSET, JOINT_DAMPING, JOINT_INERTIA, PAYLOAD_MASS, SENSOR_GAIN
from exo_sim.diagnosis.policy import healthy, priors, verdicts
from exo_sim.diagnosis.policy.recordings import FEWEST_ROWS
from exo_sim.diagnosis.subsystems.healthy_leak import OUTWARD, external_leaks
from exo_sim.diagnosis.subsystems.motion.full_scale import full_force
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.physics.declaration import declared

#: A column that moves less than this share of the forces that act says nothing of its scale.
NEGLIGIBLE = 1e-6


def nuisance_parameters(runs: Sequence[MotionRun], plant: PlantParameters, where: str) -> tuple[FreeParameter, ...]:
    """Return the nuisance parameters of the balance, without the joint's damping (see `with_damping`).

    Args:
        runs: The balances.
        plant: The nominal machine.
        where: The cylinder or joint that what resists belongs to.
    """
    run = runs[0]
    forces, inertia = run.driving, run.inertia
    lever = max((float(np.median(np.abs(v))) for k, v in run.drive.levers.items() if "pressure" in k), default=0.0)
    force = float(np.std(forces)) or float(np.std(inertia.force)) or 1.0
    spread = max(priors.FORCE_OF_ZEROS * lever, 1e-4 * force)
    if run.cylinder is None and not run.external_recorded:
        spread = priors.FORCE_UNMEASURED * float(np.std(inertia.force))
    full = full_force(run, plant) / run.drive.usual_arm
    reach = (float(priors.SENSOR_SCALE_LEAST), float(priors.SENSOR_SCALE_MOST))
    found = []
    # a free swing scales with its mass: no recording of it holds the mass
    if inertia.has_mass and any(drives(each.driving) for each in runs):
        found.append(_of_sensor(PAYLOAD_MASS, run.joint, PAYLOAD_MASS, "1", 0.02, (0.2, 5.0), (1.0, priors.MASS), neutral=1.0))
    unit = "N*m" if run.turning else "N"
    found.append(_of_sensor(FORCE_OFFSET, run.joint, FORCE_OFFSET, unit, max(spread, 1e-6), (-1e6, 1e6), (0.0, spread)))
    found += [
        _of_sensor(SENSOR_GAIN, column, f"{column}.scale", "1", priors.FORCE_SCALE, reach, (1.0, priors.FORCE_SCALE), neutral=1.0)
        for column in _scaled_columns(run)
    ]
    if run.drive.signals:
        skew = priors.CARD_SKEW
        found.append(_of_sensor("drive_delay", run.joint, DRIVE_DELAY, "s", skew, (-10.0 * skew, 10.0 * skew), (0.0, skew)))
    if run.turning:
        name = JOINT_INERTIA if inertia.alone else "inertia"  # beside other joints it also holds what those take of it
        found.append(_of_sensor(name, run.joint, "inertia", "1", 0.01, (0.5, 2.0), (1.0, priors.INERTIA), neutral=1.0))
    if float(np.std(inertia.tilt)) > 0.0:
        found.append(_of_sensor("zero", run.joint, "zero", "rad", 0.005, (-0.3, 0.3), (0.0, priors.ANGLE_ZERO)))
    for name in dict.fromkeys(name for each in runs if each.imputed is not None for name in each.imputed.uncertain):
        found.append(_of_sensor("imputed_pressure", where, name, "1", 1.0, (-20.0, 20.0), (0.0, 1.0)))
    for name in run.imputed.leaks if run.imputed is not None else ():
        spread, unit = external_leaks(plant)[name], OUTWARD.parameter(name).unit
        if unit == "m^2":  # one law will do for a trace
            found.append(_of_cylinder(OUTWARD.name, where, name, unit, spread, (0.0, 2.5 * spread), (0.0, spread)))
    contained = plant.contained_effects
    for effect in declared().values():
        if effect.cut != "motion" or effect.name not in (plant.cylinder.dtype.names or ()) or effect.identification.though_on:
            continue
        rubs = run.cylinder is not None and effect.name not in contained  # seals do, bearings do not
        for parameter in effect.parameters:
            value = float(plant.cylinder[effect.name][parameter.name][0])
            dry, most = (effect.identification.resists * share * full for share in (priors.HEALTHY_DRY, healthy.DRY_FRICTION))
            if rubs and dry > 0.0 and value == 0.0 and parameter.unit == "N":
                found.append(_of_cylinder(effect.name, where, parameter.name, "N", dry, (0.0, most), (0.0, dry)))
            if value == 0.0 and parameter.name in effect.identification.known and plant.is_on(effect):  # its law is what nobody gave
                prior, ends = effect.identification.known[parameter.name], (parameter.low, parameter.high)
                found.append(_of_cylinder(effect.name, where, parameter.name, parameter.unit, prior[1], ends, prior))
            if value != 0.0 and not parameter.choices:
                unit, known = parameter.unit_at(run.turning and run.cylinder is None), priors.KNOWN_FORCE * abs(value)
                bounds = (parameter.low, parameter.high)
                found.append(_of_cylinder(effect.name, where, parameter.name, unit, known, bounds, (value, known)))
    return tuple(found)


def _scaled_columns(run: MotionRun) -> list[str]:
    """Return the columns whose scale the balance can feel: all but the one that it feels most, by which the others are measured.

    A load cell alone is measured by the mass that it moves: one that is off must not end as a mass that is.
    """
    size = {column: float(np.mean((run.drive.levers[column] * signal) ** 2)) for column, signal in run.drive.signals.items()}
    if not size:
        return []
    reference = max(size, key=lambda column: size[column])
    if len(size) == 1 and run.inertia.has_mass and not reference.endswith("external_force"):
        reference = ""
    return [column for column in size if column != reference and size[column] > (NEGLIGIBLE * run.effort) ** 2]


def _of_sensor(
    effect: str, where: str, name: str, unit: str, scale: float, bounds: tuple[float, float], prior: tuple[float, float],
    neutral: float = 0.0,
) -> FreeParameter:  # fmt: skip
    return FreeParameter(effect, where, name, unit, Target.SENSOR, scale, *bounds, prior, neutral=neutral)


def _of_cylinder(
    effect: str, where: str, name: str, unit: str, scale: float, bounds: tuple[float, float], prior: tuple[float, float]
) -> FreeParameter:
    return FreeParameter(effect, where, name, unit, Target.CYLINDER, scale, *bounds, prior)


def with_damping_if_too_large(model: MotionModel, nuisances: tuple[FreeParameter, ...]) -> tuple[FreeParameter, ...]:
    """Return the nuisance parameters with the joint's damping among them where it is plainly too large; else as they were.

    Only then: damping that is free to move would hide viscous friction, which is the same with the opposite sign.
    """
    more = with_damping(model, nuisances)
    if not more:
        return nuisances
    damping = more[-1]
    plain, freed = (fit(model.residual, free, {q: q.start for q in free}, max_iterations=8) for free in (nuisances, more))
    plainly = freed.values[damping] < verdicts.LEAST_DAMPED and freed.sse < verdicts.LEAST_LEFT * plain.sse
    return more if plainly else nuisances


def with_damping(model: MotionModel, nuisances: tuple[FreeParameter, ...]) -> tuple[FreeParameter, ...]:
    """Return the nuisance parameters and the joint's damping; nothing where there is none or it is among them already."""
    run = model.runs[0]
    if run.passive.damping is None or model.size < FEWEST_ROWS or any(q.effect == JOINT_DAMPING for q in nuisances):
        return ()
    return (*nuisances, _of_sensor(JOINT_DAMPING, run.joint, "damping", "1", 0.1, (0.0, 1.0), (1.0, priors.DAMPING), neutral=1.0))
