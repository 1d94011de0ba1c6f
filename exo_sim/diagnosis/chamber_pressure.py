"""What is known of the pressure in a chamber once the gas has been judged: a sensor's faults and a hose between taken off.

The balance of forces is made of these pressures; left uncorrected, a late sensor or one behind a hose looks like friction. Where it is
the position that comes late, pressures are made as late as it is. Where the transmission gives, friction is asked where the piston is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.cases import Case
from exo_sim.diagnosis.filters import restored
from exo_sim.diagnosis.gas_cut import behind_hose
from exo_sim.diagnosis.gas_problem import GasProblem
from exo_sim.diagnosis.judging import Judged
from exo_sim.diagnosis.motion_cut import MotionRun, smooth_on_clock, smoothing
from exo_sim.diagnosis.split import Split
from exo_sim.diagnosis.verdict import setting_of
from exo_sim.physics.transmission import gives, stiffness

Array = NDArray[np.float64]

#: Smaller corrections than this are left alone [Pa].
LEAST = 50.0


def carried_over(case: Case, gas: Sequence[Judged], parts: Split) -> dict[str, list[MotionRun]]:
    """Return the runs of the motion cut, by joint, with every correction that a judged cylinder's gas asks for."""
    changes: dict[tuple[str, str], tuple[Array, Array]] = {}
    late: dict[str, float] = {}
    soft: dict[str, float] = {}
    for one in gas:
        if one.empty or one.nameless:
            continue
        setting = setting_of(one, one.trial)
        if gives(setting.cylinder[0]):
            soft[one.where] = float(stiffness(setting.cylinder[0]))
        if not one.named and not behind_hose(setting.cylinder):
            continue
        whole = GasProblem(case.cylinders[one.where], setting, parts, held_out=True)
        named = {q.parameter for candidate in one.named if candidate.kind == "sensor" for q in candidate.quantities}
        if "position.delay" in named:
            seconds = whole.setting.sensors["position.delay"]
            late |= {case.joint_of(one.where): seconds, f"rod of {one.where}": seconds}
        for index, feed in enumerate(whole.feeds):
            for side in range(2):
                measured = feed.run.pressure[side]
                if measured is not None:
                    change = _change(whole, index, side, measured, named)
                    if np.nanmax(np.abs(change)) > LEAST:
                        changes[feed.run.recording, f"{one.where}.pressure_{side + 1}"] = feed.time, change
    return {
        joint: [_at_piston(_late(_changed(run, changes), late.get(joint, 0.0)), soft) for run in runs]
        for joint, runs in case.joints.items()
    }


def _change(whole: GasProblem, index: int, side: int, measured: Array, named: set[str]) -> Array:
    """Return pressure in the chamber less what was measured, shape (n,) [Pa]."""
    setting, time = whole.setting, whole.feeds[index].time

    def fault(kind: str, none: float) -> float:
        name = f"pressure_{side + 1}.{kind}"
        return setting.sensors.get(name, none) if name in named else none

    true = (measured - fault("bias", 0.0)) / fault("scale", 1.0)
    late = fault("delay", 0.0)
    if late != 0.0:
        good = np.isfinite(true)
        true = np.interp(time + late, time[good], true[good])
    if behind_hose(setting.cylinder):
        shown = whole.predict(setting, index)
        true = true + shown.inside[:, side] - shown.pressure[:, side]
    return true - measured


def _changed(run: MotionRun, changes: Mapping[tuple[str, str], tuple[Array, Array]]) -> MotionRun:
    drive, gauge = run.drive, run.gauge
    for column, lever in run.levers.items():
        time, change = changes.get((run.recording, column), (run.time, None))
        if change is None or time[0] > run.time[0]:  # a run that was cut short says nothing of what came before
            continue
        smooth = smooth_on_clock(run, time, change)
        drive = drive + lever * smooth
        if run.cylinder is not None and column.startswith(f"{run.cylinder}.pressure_"):
            side, full = int(column[-1]) - 1, restored(run.time, smooth, smoothing(run.time))
            gauge = gauge + np.column_stack([full if s == side else np.zeros_like(full) for s in range(2)])
    return run if drive is run.drive else replace(run, drive=drive, gauge=gauge)


def _at_piston(run: MotionRun, soft: Mapping[str, float]) -> MotionRun:
    """Return a run whose motion is that of its piston, which is ahead of the joint by what the transmission gives."""
    spring = soft.get(run.cylinder or "")
    if spring is None:
        return run
    carried = (run.inertial - run.passive - run.external) / np.where(np.abs(run.arm) > 1e-6, run.arm, 1.0)
    ahead = restored(run.time, carried, smoothing(run.time)) / spring
    return replace(run, position=run.position + ahead, velocity=run.velocity + np.gradient(ahead, run.time))


def _late(run: MotionRun, seconds: float) -> MotionRun:
    """Return a run whose forces come as late as its position does."""
    if seconds == 0.0:
        return run

    def then(values: Array) -> Array:
        return np.interp(run.time - seconds, run.time, values)

    gauge = np.column_stack([then(run.gauge[:, side]) for side in range(2)])
    unsure, leaks = ({name: then(change) for name, change in one.items()} for one in (run.unsure, run.leaks))
    moved = replace(run, drive=then(run.drive), external=then(run.external), gauge=gauge, unsure=unsure, leaks=leaks)
    return moved if run.weighs else replace(moved, inertial=then(run.inertial), bias=then(run.bias))  # a rod's cell is measured too
