"""Pressures in the chambers as the judged gas knows them: sensor faults and a hose between sensor and chamber are taken off.

The balances of forces are made of these pressures; uncorrected, a late sensor or one behind a hose looks like friction. Where it is the
position that comes late, pressures are delayed alike. Where the transmission gives, friction is evaluated at the piston
(`piston_motion.py`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.coupling.piston_motion import at_piston
from exo_sim.diagnosis.data import open_questions
from exo_sim.diagnosis.data.coarse_clock import begins_with
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.correlation import rms
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.nominal_numbers import CARD_OF_PRESSURES, POSITION_DELAY
from exo_sim.diagnosis.policy.healthy import FORCE_BOUND_SHARE
from exo_sim.diagnosis.policy.recordings import CORRECTED_PRESSURE
from exo_sim.diagnosis.selection.sensor_zero import is_faulty, zeros_within
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.gas.prediction import behind_hose
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothed_on_clock, smoothing_width
from exo_sim.physics.transmission import gives
from exo_sim.recording.filters import restored
from exo_sim.simulation.replay.external_drive import external_power

Array = NDArray[np.float64]

#: By recording and column, clock [s] and change of the pressure [Pa], shape (n,) each.
Changes = Mapping[tuple[str, str], tuple[Array, Array]]


def with_corrected_pressures(data: MachineData, gas: Sequence[SubsystemResult[GasModel]], split: Split) -> MachineData:
    """Return the data with corrected balances; a joint that then proves to be driven from outside becomes an open question.

    So does one whose pressures were recorded behind hoses in which something without a name acts, where what the hose changes of them is
    more than the balance of a healthy machine leaves: nobody knows the pressures in the chambers.
    """
    joints, open_, driven = {}, list(data.open_questions), set(data.externally_driven)
    behind = with_corrections(data, [_hidden_by_hose(data, one, split) for one in gas])
    for joint, runs in corrected_balances(data, gas, split).items():
        kept = []
        for run, before, hidden in zip(runs, data.joints[joint], behind[joint], strict=True):
            if hidden is not before and rms(hidden.drive.force - before.drive.force) > FORCE_BOUND_SHARE * before.effort:
                open_.append(open_questions.of_pressures_behind_hose(run.joint, run.recording))
                continue
            unsure = run is not before and run.inertia.has_mass and not run.external_recorded
            why = _external_power(run) if unsure else ""
            if why:
                driven.add(run.joint)
                open_.append(open_questions.of_balance(run.joint, run.recording, open_questions.Unjudged(why)))
            else:
                kept.append(run)
        if kept:
            joints[joint] = tuple(kept)
    zeros = {column: most for one in gas for column, most in zeros_within(one).items()}
    return replace(data, joints=joints, open_questions=tuple(open_), externally_driven=frozenset(driven), zeros_within=zeros)


def _external_power(run: MotionRun) -> str:
    speed = run.kinematics.velocity / run.drive.divisor
    return external_power(run.time, run.demand, run.drive.force, speed, run.judged)


def corrected_balances(
    data: MachineData, gas: Sequence[SubsystemResult[GasModel]], split: Split
) -> dict[str, tuple[MotionRun, ...]]:
    """Return the balances of forces, by joint, with every correction that a cylinder's gas asks for."""
    return with_corrections(data, [correction_of(data, one, split) for one in gas])


@dataclass(frozen=True)
class Correction:
    """What one cylinder's gas asks for of the balances of forces.

    Attributes:
        changes: Of its pressures.
        late: By balance, by how much its forces come late, as the position does [s].
        soft: By cylinder whose transmission gives, its record, shape (1,).
    """

    changes: Changes = field(default_factory=dict)
    late: Mapping[str, float] = field(default_factory=dict)
    soft: Mapping[str, NDArray[np.void]] = field(default_factory=dict)


def _hidden_by_hose(data: MachineData, one: SubsystemResult[GasModel], split: Split) -> Correction:
    """Return what a hose before the sensors of a gas changes of its pressures, where something in that gas has no name."""
    if one.is_empty or not one.has_unknown or not behind_hose(one.final_plant.cylinder):
        return Correction()
    return Correction(_changes(data, one, split, set()))


def correction_of(data: MachineData, one: SubsystemResult[GasModel], split: Split) -> Correction:
    """Return what one cylinder's gas asks for; nothing where something in it has no name."""
    if one.is_empty or one.has_unknown:
        return Correction()
    plant, late = one.final_plant, dict[str, float]()
    soft = {one.where: plant.cylinder} if gives(plant.cylinder[0]) else {}
    faults = {q.parameter for candidate in one.named if candidate.kind is Kind.SENSOR for q in candidate.parameters}
    faults |= {q.parameter for q, error in one.refitted if is_faulty(one, q, error)}
    if not faults and not behind_hose(plant.cylinder):
        return Correction(soft=soft)
    if POSITION_DELAY in faults:
        seconds = plant.sensors[POSITION_DELAY]
        late = {data.joint_of(one.where): seconds, f"rod of {one.where}": seconds}
    return Correction(_changes(data, one, split, faults), late, soft)


def _changes(data: MachineData, one: SubsystemResult[GasModel], split: Split, faults: set[str]) -> Changes:
    """Return what these faults of its sensors and a hose before them change of the pressures of a gas."""
    changes: dict[tuple[str, str], tuple[Array, Array]] = {}
    whole = one.model.over_whole_runs(one.final_plant, split)
    for index, given in enumerate(whole.inputs):
        behind = _behind_hose(whole, index)
        for side in range(2):
            measured = given.run.pressure[side]
            if measured is not None:
                change = _change(whole, index, side, measured, faults, behind)
                if np.nanmax(np.abs(change)) > CORRECTED_PRESSURE:
                    table = data.table(given.run.recording).time
                    changes[given.run.recording, f"{one.where}.pressure_{side + 1}"] = _on_the_clock_of(table, given.time, change)
    return changes


def with_corrections(data: MachineData, corrections: Sequence[Correction]) -> dict[str, tuple[MotionRun, ...]]:
    """Return the balances of forces, by joint, with these corrections, one of each cylinder."""
    changes = {column: change for one in corrections for column, change in one.changes.items()}
    late = {joint: seconds for one in corrections for joint, seconds in one.late.items()}
    soft = {cylinder: record for one in corrections for cylinder, record in one.soft.items()}
    return {
        joint: tuple(at_piston(_delayed(_changed(run, changes), late.get(joint, 0.0)), soft.get(run.cylinder or "")) for run in runs)
        for joint, runs in data.joints.items()
    }


def _on_the_clock_of(table: Array, time: Array, change: Array) -> tuple[Array, Array]:
    """Return a change on the clock of its recording, from where it begins on: a quick logger's gas is predicted on a coarser one."""
    clock = table if begins_with(time, table) else table[table >= time[0]]
    return clock, np.interp(clock, time, change)


def _behind_hose(whole: GasModel, index: int) -> tuple[Array, Array] | None:
    """Return what is predicted in the chambers and where the sensors sit, shape (n, 2) each [Pa]; None where no hose lies between them."""
    if not behind_hose(whole.nominal.cylinder):
        return None
    shown = whole.predict(whole.nominal, index)
    return shown.inside, shown.pressure if shown.before_sensors is None else shown.before_sensors  # their faults are taken off apart


def _change(
    whole: GasModel, index: int, side: int, measured: Array, faults: set[str], behind: tuple[Array, Array] | None
) -> Array:
    """Return pressure in the chamber less what was measured, shape (n,) [Pa]; `behind` of `_behind_hose`."""
    plant, time = whole.nominal, whole.inputs[index].time

    def fault(kind: str, none: float) -> float:
        name = f"pressure_{side + 1}.{kind}"
        return plant.sensors.get(name, none) if name in faults else none

    true = (measured - fault("bias", 0.0)) / fault("scale", 1.0)
    late = fault("delay", 0.0) + (plant.sensors[CARD_OF_PRESSURES] if CARD_OF_PRESSURES in faults else 0.0)
    if late != 0.0:
        good = np.isfinite(true)
        true = np.interp(time + late, time[good], true[good])
    if behind is not None:
        inside, shown = behind
        true = true + inside[:, side] - shown[:, side]
    return true - measured


def _changed(run: MotionRun, changes: Changes) -> MotionRun:
    force, gauge, signals = run.drive.force, run.drive.gauge, dict(run.drive.signals)
    for column, lever in run.drive.levers.items():
        time, change = changes.get((run.recording, column), (run.time, None))
        if change is None or time[0] > run.time[0]:  # a run that was cut short says nothing of what came before
            continue
        smooth = smoothed_on_clock(run, time, change)
        force = force + lever * smooth
        if column in signals:
            signals[column] = signals[column] + smooth
        if run.cylinder is not None and column.startswith(f"{run.cylinder}.pressure_"):
            side, full = int(column[-1]) - 1, restored(run.time, smooth, smoothing_width(run.time, run.smoothing))
            gauge = gauge + np.column_stack([full if s == side else np.zeros_like(full) for s in range(2)])
    return run if force is run.drive.force else replace(run, drive=replace(run.drive, force=force, gauge=gauge, signals=signals))


def _delayed(run: MotionRun, seconds: float) -> MotionRun:
    """Return a run whose forces are delayed as its position is."""
    if seconds == 0.0:
        return run

    def then(values: Array) -> Array:
        return np.interp(run.time - seconds, run.time, values)

    drive, inertia, imputed = run.drive, run.inertia, run.imputed
    gauge = np.column_stack([then(drive.gauge[:, side]) for side in range(2)])
    signals = {column: then(values) for column, values in drive.signals.items()}
    drive = replace(drive, force=then(drive.force), gauge=gauge, signals=signals)
    if imputed is not None:
        uncertain, leaks = ({name: then(change) for name, change in one.items()} for one in (imputed.uncertain, imputed.leaks))
        imputed = replace(imputed, uncertain=uncertain, leaks=leaks)
    if not inertia.has_mass:  # a rod's cell is measured too
        inertia = replace(inertia, force=then(inertia.force), bias=then(inertia.bias))
    return replace(run, drive=drive, inertia=inertia, external=then(run.external), imputed=imputed)
