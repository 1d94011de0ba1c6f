"""How large forces, speeds, travels and pressures are in the recordings of a balance: what its laws are tried at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exo_sim.diagnosis.policy import priors
from exo_sim.diagnosis.policy.recordings import VARIED_PRESSURE
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.physics.effects import coulomb_friction


@dataclass(frozen=True)
class MotionScales:
    """Scales of a balance of forces.

    Attributes:
        level: Dry friction about which its laws are formed: the nominal one, or half of what is missing [N or N m].
        size: Root mean square that a law may make up, in units of the noise of a row.
        slowest, fastest: Speeds between which nearly all of the motion lies, as far as a row resolves it [m/s or rad/s].
        travel: Standard deviation of the position [m or rad].
        pressure, most_pressure: Mean and largest sum of both chambers' pressures above the atmosphere [Pa].
        has_pressure, two_pressures: Whether that sum varies, and whether each of the two does.
    """

    level: float
    size: float
    slowest: float
    fastest: float
    travel: float
    pressure: float
    most_pressure: float
    has_pressure: bool
    two_pressures: bool

    @classmethod
    def of(cls, model: MotionModel) -> MotionScales:
        """Return the scales of a balance."""
        first, lacking = model.runs[0], model.residual({})
        missing = float(np.std(lacking * model.scale)) if lacking.size else 0.0
        known = float(model.nominal.cylinder[coulomb_friction.EFFECT.name]["force"][0])
        effort = max(run.effort for run in model.runs)
        speed = np.abs(np.concatenate([run.kinematics.velocity for run in model.runs]))
        moving = speed[speed > first.kinematics.still]
        both = np.concatenate([run.drive.gauge for run in model.runs])
        gauge = np.concatenate([np.maximum(run.drive.gauge, 0.0).sum(axis=1) for run in model.runs])
        pressure = float(np.mean(gauge))
        return cls(
            level=max(known, 0.5 * missing / first.drive.usual_arm, 1e-9),
            size=max(missing, priors.LEAST_FORCE_SIZE * effort) / model.noise if model.noise else 1.0,
            slowest=max(float(np.percentile(moving, 1.0)), model.slowest_resolved) if moving.size else 1e-6,
            fastest=float(np.percentile(moving, 99.0)) if moving.size else 1.0,
            travel=max(float(np.std(np.concatenate([run.kinematics.position for run in model.runs]))), 1e-9),
            pressure=pressure,
            most_pressure=float(gauge.max(initial=0.0)),
            has_pressure=pressure > 0.0 and float(np.std(gauge)) > VARIED_PRESSURE * pressure,
            two_pressures=bool((np.ptp(both, axis=0) > VARIED_PRESSURE * pressure).all()),
        )
