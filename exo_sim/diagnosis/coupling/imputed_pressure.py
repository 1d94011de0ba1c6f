"""Balances of forces that lack one pressure: the gas of its cylinder, as judged by the other chamber, predicts it.

The chamber that nobody measured follows from the command, the motion and the supply by the same equations that the other chamber was
judged with. What the other chamber does not tell (the initial pressure, the dead volume, and a leak where none of the cylinder is known)
stays free in the balance.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from exo_sim.diagnosis.data import open_questions
from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.motion_run import Imputed, MotionRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.correlation import rms
from exo_sim.diagnosis.estimation.parameters import PlantParameters, Target
from exo_sim.diagnosis.policy import priors
from exo_sim.diagnosis.policy.recordings import UNCERTAIN_PRESSURE
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.healthy_leak import OUTWARD, external_leaks
from exo_sim.diagnosis.subsystems.motion.motion_runs import motion_runs
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothed_alike, smoothed_on_clock
from exo_sim.recording.table import Recording
from exo_sim.recording.windows import clock_breaks
from exo_sim.simulation.replay.external_drive import externally_driven

Array = NDArray[np.float64]

#: Tolerance of the initial pressure that suits the balance best [Pa].
START_TOLERANCE = 500.0
#: The balance of the first seconds tells the initial pressure of an unmeasured chamber [s]; of a whole recording that is held out, its
#: beginning may be used for that.
SOON, BEGINNING = 0.05, 1.0


def with_initial_pressure(data: MachineData, run: CylinderRun) -> CylinderRun:
    """Return a run with the initial pressure, by the balance of forces, of a chamber that nobody measured."""
    table, side = data.table(run.recording), _unmeasured_side(data, run)
    if side is None:
        return run
    column, atmosphere = f"{run.cylinder}.pressure_{side + 1}", data.rig.environment.pressure
    _, balance = _balance_with(data, table, run.cylinder, column, np.full(len(table.time), atmosphere))
    if balance is None or column not in balance.drive.levers:
        return run
    soon = balance.time < balance.time[0] + SOON
    pressure = atmosphere + float(np.median(_missing(balance)[soon] / balance.drive.levers[column][soon]))
    initial = [math.nan, math.nan]
    initial[side] = float(np.clip(pressure, *_possible_range(data, run)))
    return replace(run, initial=(initial[0], initial[1]))


def with_imputed_pressures(data: MachineData, gas: Sequence[SubsystemResult[GasModel]], split: Split) -> MachineData:
    """Return the data with the balances that lack one pressure of a cylinder whose gas was judged; their open questions are taken off.

    Where another recording holds all that the balance of a joint needs, that one is judged alone.
    """
    for one in gas:
        if one.is_empty or one.has_unknown:
            continue
        joint = data.joint_of(one.where)
        if all(_unmeasured_side(data, run) is None for run in one.model.all_runs):
            continue
        whole = one.model.over_whole_runs(one.final_plant, split)
        for index, given in enumerate(whole.inputs):
            side = _unmeasured_side(data, given.run)
            if side is None or any(run.imputed is None for run in data.joints.get(joint, ())):
                continue
            run = _Unmeasured(data, one, whole, index, side).balance()
            if run is None:
                continue
            closed = open_questions.of_balance(joint, run.recording, open_questions.Unjudged("")).question
            says = (
                f"{run.recording}: {one.where}.pressure_{side + 1} was not recorded; the balance of forces takes what the gas, "
                "as judged by the other chamber, predicts"
            )
            data = replace(
                data,
                joints={**data.joints, joint: (*data.joints.get(joint, ()), run)},
                open_questions=tuple(question for question in data.open_questions if question.question != closed),
                remarks=(*data.remarks, says),
            )
    return data


class _Unmeasured:
    """The chamber of one run that nobody measured, as the judged gas of its cylinder predicts it."""

    def __init__(self, data: MachineData, result: SubsystemResult[GasModel], whole: GasModel, index: int, side: int):
        self.data, self.result, self.whole, self.index, self.side = data, result, whole, index, side
        self.given = whole.inputs[index]
        self.table = data.table(self.given.run.recording)
        self.column = f"{result.where}.pressure_{side + 1}"

    def balance(self) -> MotionRun | None:
        """Return the balance of the cylinder's joint; None where even then it cannot be judged."""
        plant, data = self.whole.nominal, self.data
        initial = self._initial()
        if initial is None:
            return None
        pressure = self._pressure(plant, initial)
        longer, run = _balance_with(data, self.table, self.result.where, self.column, pressure)
        if run is None or run.cylinder is None or run.joint in externally_driven(longer, data.rig, data.model, data.links):
            return None
        lever = run.drive.levers[self.column]
        levers = {column: values for column, values in run.drive.levers.items() if column != self.column}
        signals = {column: values for column, values in run.drive.signals.items() if column != self.column}

        def response(changed: Array) -> Array:
            return lever * smoothed_on_clock(run, self.table.time, changed - pressure)

        uncertain = {f"start of {run.recording}": response(self._pressure(plant, initial + priors.UNMEASURED_INITIAL))}
        uncertain |= {name: response(self._pressure(changed, initial)) for name, changed in _one_off(self.result)}
        least = UNCERTAIN_PRESSURE * float(np.median(np.abs(lever)))
        leaks = {name: response(self._pressure(leaky, initial)) / size for name, size, leaky in self._with_leaks(plant)}
        if not all(np.isfinite(change).all() for change in (pressure, *uncertain.values(), *leaks.values())):
            return None
        missed = smoothed_alike(self.table.time, self.whole.errors(plant)[self.index][:, 1 - self.side], asked=run.smoothing)
        other = rms(missed[self._usable(self.table.time)])
        return replace(
            run,
            drive=replace(run.drive, levers=levers, signals=signals),
            imputed=Imputed({name: change for name, change in uncertain.items() if float(np.max(np.abs(change))) > least}, leaks),
            noise=float(np.hypot(run.noise, other * np.sqrt(np.mean(lever**2)))),
        )

    def _pressure(self, plant: PlantParameters, initial: float) -> Array:
        """Return the pressure of a plant that begins with this one, shape (n,) [Pa]."""
        windows = self.given.windows
        starts = windows.pressure.copy()
        starts[0, self.side] = initial
        alone = copy(self.whole)
        alone.inputs = [replace(self.given, windows=replace(windows, pressure=starts))]
        return alone.predict(plant, 0).inside[:, self.side]

    def _initial(self) -> float | None:
        """Return the initial pressure that leaves least in the balance of all that follows [Pa]."""
        plant = self.whole.nominal
        low, high = _possible_range(self.data, self.given.run)
        guess = self._pressure(plant, low)
        _, run = _balance_with(self.data, self.table, self.result.where, self.column, guess)
        if run is None:
            return None
        lever, missing, usable = run.drive.levers[self.column], _missing(run), self._usable(run.time)

        def left(initial: float) -> float:
            changed = smoothed_on_clock(run, self.table.time, self._pressure(plant, initial) - guess)
            rest = (missing - lever * changed)[usable]
            return float(np.mean(np.abs(rest - np.median(rest))))

        return float(minimize_scalar(left, bounds=(low, high), method="bounded", options={"xatol": START_TOLERANCE}).x)

    def _usable(self, time: Array) -> NDArray[np.bool_]:
        """Return at which times parameters may be fitted; of a recording that is held out whole at its beginning, shape (n,)."""
        fitted = self.whole.split.in_training(self.table.name, time)
        return fitted if fitted.any() else time < time[0] + BEGINNING

    def _with_leaks(self, plant: PlantParameters) -> Iterator[tuple[str, float, PlantParameters]]:
        """Yield each parameter of a leak of this chamber alone, a size of it, and the plant that has it; none where a leak is known."""
        if plant.is_on(OUTWARD):
            return
        for name, size in external_leaks(plant).items():
            if name.endswith(str(self.side + 1)):
                leaky = plant.copy()
                leaky.cylinder[OUTWARD.name][name] = size
                yield name, size, leaky


def _unmeasured_side(data: MachineData, run: CylinderRun) -> int | None:
    """Return which of two chambers was not measured, 0 or 1; None where that is not the question, or a load cell answers it.

    Nor is it one across a jump of the clock: nobody knows what the chamber did meanwhile.
    """
    lacking = [side for side in range(2) if run.pressure[side] is None]
    table = data.table(run.recording)
    whole = len(run.time) == len(table.time) and len(clock_breaks(run.time, table.breaks)) == 1
    if data.rig.cylinders[run.cylinder].single_acting or run.force is not None or not whole or len(lacking) != 1:
        return None
    return lacking[0]


def _possible_range(data: MachineData, run: CylinderRun) -> tuple[float, float]:
    """Return between which pressures a chamber may begin [Pa]."""
    atmosphere = data.rig.environment.pressure
    highest = [data.rig.supply.pressure if run.supply is None else float(np.max(run.supply)), 2.0 * atmosphere]
    highest += [float(np.nanmax(pressure)) for pressure in run.pressure if pressure is not None]
    return 0.5 * atmosphere, max(highest)


def _balance_with(
    data: MachineData, table: Recording, cylinder: str, column: str, pressure: Array
) -> tuple[Recording, MotionRun | None]:
    """Return a recording with one pressure more, and by it the balance of the joint that a cylinder drives."""
    joint = data.joint_of(cylinder)
    longer = replace(table, columns={**table.columns, column: pressure}, units={**table.units, column: "Pa"})
    return longer, next((run for run in motion_runs(longer, data.rig, data.model, data.links)[0] if run.joint == joint), None)


def _missing(run: MotionRun) -> Array:
    """Return what the forces of a balance lack before anything resists, shape (n,)."""
    return run.demand - run.drive.force - run.external


def _one_off(result: SubsystemResult[GasModel]) -> Iterator[tuple[str, PlantParameters]]:
    """Yield every parameter that the judged gas depends on, by name, with the plant that has it off by one standard error."""
    fitted = result.final
    errors = result.fits.standard_errors(fitted)
    for parameter, value in fitted.fit.values.items():
        step = errors.get(parameter, 0.0)
        changed = value + step if value + step <= parameter.high else max(value - step, parameter.low)
        if parameter.target is not Target.SENSOR and changed != value:
            yield " ".join(parameter.key), result.model.apply({**fitted.fit.values, parameter: changed}, fitted.fixed)
