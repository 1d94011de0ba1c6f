"""The balance of forces of one joint, or along one rod, as a least-squares problem: the whitened force that is missing."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from copy import copy
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.discrepancy.trace import Trace
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Values
from exo_sim.diagnosis.findings import Finding, Series, Subsystem
from exo_sim.diagnosis.nominal_numbers import DRIVE_DELAY, JOINT_INERTIA, PAYLOAD_MASS
from exo_sim.diagnosis.policy import healthy, significance
from exo_sim.diagnosis.policy.off_nominal import MASS_FORM
from exo_sim.diagnosis.subsystem_model import Comparison, SubsystemModel
from exo_sim.diagnosis.subsystems.motion.contact_scatter import ContactScatter, friction_of_noise
from exo_sim.diagnosis.subsystems.motion.discrepancy_basis import friction_discrepancy
from exo_sim.diagnosis.subsystems.motion.experiments import resisted
from exo_sim.diagnosis.subsystems.motion.full_scale import full_force
from exo_sim.diagnosis.subsystems.motion.indistinguishable import (
    constant_force_of_zeros,
    friction_beside_constant_force,
    scale_instead_of_mass,
    sensor_error_of,
)
from exo_sim.diagnosis.subsystems.motion.missing_force import MissingForce
from exo_sim.diagnosis.subsystems.motion.missing_pattern import closer_over, force_or_friction, signals_of
from exo_sim.diagnosis.subsystems.motion.onsets import Onsets, Starting, onsets_of
from exo_sim.diagnosis.subsystems.motion.regimes import regimes
from exo_sim.diagnosis.subsystems.motion.row_set import RowSet
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothed_alike
from exo_sim.physics.declaration import declared
from exo_sim.physics.effects import presliding

Array = NDArray[np.float64]


class MotionModel(SubsystemModel):
    """The balance of one joint or rod, any number of runs.

    Args:
        runs: The balances.
        nominal: The nominal machine; its cylinder record holds what resists the motion.
        split: Which time may be used.
        on_test: Whether the rows are those of the test time.
        scatter: Of the contact at low speeds; None where there is none.
        creep: Speed at which dry friction has built up [m/s or rad/s]; 0 where it is there at once.
        starting: How its onsets are read; None where they do not count.
    """

    kind = Subsystem.MOTION
    balance = "force balance"
    plant_holds_curves = False

    def __init__(self, runs: Sequence[MotionRun], nominal: PlantParameters, split: Split, on_test: bool = False,
                 scatter: ContactScatter | None = None, creep: float = 0.0, starting: Starting | None = None):  # fmt: skip
        first = runs[0]
        self.where, self.runs, self.nominal = first.cylinder or first.joint, tuple(runs), nominal.copy()
        self.is_of_joint = first.cylinder is None
        self.nominal.cylinder["effective_mass"] = first.inertia.effective_mass
        self.nominal.cylinder["turning"] = float(first.turning and first.cylinder is None)
        self.unit = "N*m" if first.turning else "N"
        self._lacking = [MissingForce(run) for run in self.runs]
        self._set = RowSet.of(self.runs, split, on_test)
        self.noise = float(np.median(self._set.scale)) if self._set.scale.size else 0.0
        self._split, self._starting = split, starting
        if starting is not None:
            self._set = self._set.with_onsets(self._onsets(starting))
        self._weigh(scatter, 0.0)
        contact = self.nominal.cylinder[presliding.EFFECT.name]
        if not first.turning and float(contact["stiffness"][0]) == 0.0:
            contact["stiffness"] = self._stiff_contact()
        self._weigh(scatter, creep)

    def _weigh(self, scatter: ContactScatter | None, creep: float) -> None:
        """Set the standard deviation of each row: where its contact scatters, and how noise of the velocity moves friction that creeps."""
        self._scatter, self._creep = scatter, creep
        self.blocks, self.scale = self._set.blocks, self._set.scale.copy()
        if scatter is not None:
            self.scale[: self._set.of_motion] *= scatter.at(self.speed[: self._set.of_motion])
        if creep > 0.0:
            noise = np.array([run.kinematics.velocity_noise for run in self.runs])[self._set.recording]
            self.scale = np.hypot(self.scale, friction_of_noise(self.friction, self.speed, noise, creep))

    @property
    def speed(self) -> Array:
        """Mean speed of each row [m/s or rad/s], shape (size,)."""
        return np.abs(self.velocity)

    @property
    def velocity(self) -> Array:
        """Mean velocity of each row [m/s or rad/s], shape (size,)."""
        return self._set.velocity

    @property
    def slowest_resolved(self) -> float:
        """Speed below which the contact scatters too much for a law of speed to show [m/s or rad/s]; 0 where it does not."""
        return 0.0 if self._scatter is None else self._scatter.settles_at()

    def with_contact(self, scatter: ContactScatter | None, creep: float = 0.0) -> MotionModel:
        """Return the model with rows of less weight where the contact scatters, or where friction turns with little speed.

        Args:
            scatter, creep: As of the model.
        """
        if scatter is None and creep <= 0.0:
            return self
        other = copy(self)  # what was predicted of rows stays so, whatever their weight
        other._weigh(scatter, creep)
        return other

    @property
    def creeps_below(self) -> float:
        """Speed at which dry friction is there [m/s or rad/s]: what rests until it breaks loose creeps no faster; infinite elsewhere."""
        return math.inf if self._starting is None else max(run.kinematics.still for run in self.runs)

    def with_onsets(self, starting: Starting) -> MotionModel:
        """Return the model with a row for every onset of motion behind its others."""
        other = copy(self)
        other._starting, other._set = starting, self._set.with_onsets(self._onsets(starting))
        other._weigh(self._scatter, self._creep)
        return other

    @property
    def constant_of_zeros(self) -> float:
        return constant_force_of_zeros(self.runs)

    @property
    def lever(self) -> Array:
        """Size of the lever between the balance and where friction acts, of each row [m/rad, or 1], shape (size,)."""
        return np.abs(self._set.means(lambda run: run.drive.arm))

    def friction_of_rows(self) -> Array:
        """Return what resists the motion in each row where friction acts, against it, as a machine without any says [N or N m].

        Of onsets it is that beside their damping.
        """
        arm = self._set.means(lambda run: run.drive.divisor)
        return -np.sign(self.velocity) * self._set.missing(self.without_friction) / arm

    def onset_peaks(self, constant: float) -> Array:
        """Return what resists at the peak of each onset beside damping and a constant force [N or N m], shape (k,)."""
        return self._set.onset_peaks(constant)

    def _onsets(self, starting: Starting) -> list[tuple[int, Onsets]]:
        """Return the onsets of every recording that has any, with its number."""
        bare, found = self.without_friction, []
        for number, (run, usable) in enumerate(zip(self.runs, self._set.usable, strict=True)):
            onsets = onsets_of(run, usable, -self.missing(bare, number) / run.drive.divisor, starting)
            if onsets.at.size:
                found.append((number, onsets))
        return found

    @property
    def creeps(self) -> bool:
        """Whether noise of the velocity takes plainly from the weight of rows where friction builds up."""
        return bool((self.scale > healthy.SETTLED_SCATTER * self._set.scale).any())

    def _stiff_contact(self) -> float:
        """Return the stiffness of a dry contact that slides at once, whatever the level of its friction [N/m]."""
        missing = self.residual({}) * self.scale
        arm = self.runs[0].drive.usual_arm
        level = 0.5 * float(np.std(missing)) / arm if missing.size else 0.0
        return max(float(healthy.STIFF_CONTACT), level / healthy.STIFF_TRAVEL)

    @property
    def has_imputed_pressure(self) -> bool:
        """Whether a pressure in it was not measured."""
        return any(run.imputed is not None for run in self.runs)

    @property
    def practical_significance(self) -> float:
        floor = significance.FORCE_SIGNIFICANT * full_force(self.runs[0], self.nominal)
        return floor / self.noise if self.noise else 0.0

    @property
    def discrepancy_bound(self) -> float:
        force = max((run.effort for run in self.runs), default=0.0)
        floor = max(healthy.FORCE_BOUND_SHARE * force, healthy.FORCE_BOUND_STALL * full_force(self.runs[0], self.nominal))
        return floor / self.noise if self.noise else 0.0

    def missing(self, plant: PlantParameters, index: int) -> Array:
        """Return the force that the balance of a run lacks at every sample [N or N m], shape (n,)."""
        return self._lacking[index].of(plant)

    def residual_of(self, plant: PlantParameters) -> Array:
        return self._set.missing(plant) / self.scale

    def on_test_time(self, split: Split) -> MotionModel:
        return MotionModel(self.runs, self.nominal, split, True, self._scatter, self._creep, self._starting)

    @cached_property
    def friction(self) -> float:
        """All friction that acts, what the rig knows of it and what is missing, root mean square about its mean [N or N m].

        What every law of friction gets wrong is a share of that, not of what a rig that knows its friction still lacks; and no machine
        has less of it than a healthy one may have unsaid. It is that of the motion, whether onsets count or not.
        """
        plants = (self.nominal, self.without_friction) if self._set.of_motion else ()
        sizes = [float(np.std(self._set.missing(plant)[: self._set.of_motion])) for plant in plants]
        return max(self.healthy_friction, *sizes) if self.size else 0.0

    @property
    def without_friction(self) -> PlantParameters:
        """The nominal machine without any friction."""
        bare = self.nominal.copy()
        for effect in declared().values():
            if effect.family == "friction" and effect.name in (bare.cylinder.dtype.names or ()):
                bare.cylinder[effect.name] = np.zeros(1, bare.cylinder.dtype[effect.name])
        return bare

    @property
    def healthy_friction(self) -> float:
        """Friction that any healthy cylinder may have unsaid [N or N m]."""
        return healthy.DRY_FRICTION * full_force(self.runs[0], self.nominal)

    def discrepancy_basis(self) -> DiscrepancyBasis:
        """Return what every model of friction gets wrong, as columns for the rows of the residual."""
        position, time = (self._set.means(one) for one in (lambda run: run.kinematics.position, lambda run: run.time - run.time[0]))
        typical = self.noise or 1.0
        friction = self.friction / typical
        effort = max((run.effort for run in self.runs), default=0.0) / typical
        return friction_discrepancy(
            position, self.velocity, time, self._set.recording, typical / self.scale, friction, effort, self._set.of_motion
        )

    def healthy_misfit(self) -> Array:
        return self.discrepancy_basis().deviation()

    def compared(self, before: PlantParameters, after: PlantParameters, curve: Curve | None = None) -> list[Comparison]:
        found = []
        for index, run in enumerate(self.runs):
            first, second = self.missing(before, index), self.missing(after, index)
            variables = signals_of(run)
            if curve is not None and curve.variable in variables:
                way = -np.sign(run.kinematics.velocity) if curve.resists else 1.0
                second = second - smoothed_alike(run.time, way * run.drive.arm * curve(variables[curve.variable]), asked=run.smoothing)
            moving = np.where(run.judged & (np.abs(run.kinematics.velocity) > run.kinematics.still), 1.0, np.nan)
            noise = self.noise or run.noise
            balance = (run.demand * moving, (run.demand - first) * moving, (run.demand - second) * moving)
            series = Series(run.recording, f"{self.where}.force_balance", self.unit, run.time, *balance, noise)
            compared = self._set.rows[index].compared
            found.append(Comparison(series, first[compared], second[compared]))
        return found

    def traces(self, plant: PlantParameters) -> list[Trace]:
        found = []
        for index, run in enumerate(self.runs):
            error = np.where(self._set.rows[index].compared, self.missing(plant, index), np.nan)
            noise = self.noise or 1.0
            ways = regimes(run.kinematics.velocity, run.time)
            found.append(Trace(self.where, self.balance, self.unit, run.recording, run.time, error, noise, ways))
        return found

    def discrepancies(self, plant: PlantParameters) -> tuple[Discrepancy, ...]:
        """Return what the balance lacks at the piston: a force along its positive direction, or one against its motion.

        Whichever of the two follows a signal more closely.
        """
        return (max(self._patterns(plant), key=lambda one: one.pattern),)

    def discrepancy_over(self, plant: PlantParameters, variables: Sequence[str]) -> Discrepancy:
        return closer_over(self._patterns(plant), variables)

    def _patterns(self, plant: PlantParameters) -> tuple[Discrepancy, Discrepancy]:
        missing = [self.missing(plant, index) for index in range(len(self.runs))]
        return force_or_friction(self.runs, self._set.rows, missing, self.blocks, self.unit, self.balance)

    def column(self, variable: str) -> str:
        if variable in ("position", "velocity"):
            return f"{self.runs[0].joint}.{variable}"
        return variable if variable == "time" else f"{self.where}.{variable}"

    def as_sensor_error(self, parameter: FreeParameter, value: float) -> tuple[str, str, str, float] | None:
        return sensor_error_of(self.runs[0].drive, parameter, value)

    def late_columns(self, delays: Mapping[str, float], data: MachineData) -> Mapping[str, float]:
        run, behind = self.runs[0], delays.get(DRIVE_DELAY, 0.0)
        return {f"{run.joint}.position": max(-behind, 0.0), **dict.fromkeys(run.drive.signals, max(behind, 0.0))}

    def experiments(self, plants: Sequence[PlantParameters]) -> Mapping[str, Array]:
        place = np.concatenate([run.kinematics.position for run in self.runs])
        gauge = max((float(np.max(run.drive.gauge)) for run in self.runs if run.cylinder is not None), default=0.0)
        scale = float(np.median(self.scale)) if self.scale.size else 1.0
        arm = self.runs[0].drive.usual_arm
        forces = resisted(float(np.min(place)), float(np.max(place)), gauge, plants, arm)
        return {do: arm * each[:, ::4] / scale for do, each in forces.items()}  # a row of the fit takes four of its samples

    def error_of_form(
        self, parameter: FreeParameter, error: float, values: Values, fixed: Sequence[tuple[FreeParameter, float]] = ()
    ) -> float:
        return MASS_FORM * error if parameter.effect in (PAYLOAD_MASS, JOINT_INERTIA) else 0.0

    def twins_of_number(self, parameter: FreeParameter) -> tuple[str, ...]:
        return scale_instead_of_mass(self.runs, parameter)

    def indistinguishable(self, findings: Sequence[Finding], fit: Fit) -> Mapping[tuple[str, str], tuple[str, ...]]:
        return friction_beside_constant_force(findings, fit, self.runs)
