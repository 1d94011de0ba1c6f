"""Which balances of a machine can be judged by its recordings, and which questions stay open."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.conventions.fed_chambers import fed_cylinders
from exo_sim.conventions.filling import rate_for_gas
from exo_sim.diagnosis.data import open_questions
from exo_sim.diagnosis.data.coarse_clock import on_coarse_clock
from exo_sim.diagnosis.data.cylinder_run import CylinderRun, cylinder_runs
from exo_sim.diagnosis.data.decay_onset import from_decay_onset
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.data.open_questions import Unjudged
from exo_sim.diagnosis.policy.recordings import FEWEST_A_SECOND, FEWEST_FOR_EVENTS, QUIET, SAME_SIGNAL, SLOW_CHANGE, SLOW_NOISE
from exo_sim.diagnosis.subsystems.motion.contact_forces import are_recorded
from exo_sim.diagnosis.subsystems.motion.load_cell import rod_run
from exo_sim.diagnosis.subsystems.motion.motion_runs import motion_runs
from exo_sim.recording.noise import white_noise
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig
from exo_sim.simulation.replay.external_drive import external_power, externally_driven

_FED = "something lets gas in of which no command was recorded"
_RECORD_FED = "record the command of what lets gas in as well"


def sort(data: MachineData) -> MachineData:
    """Return the data with every balance that can be judged, and the questions that cannot."""
    cylinders: dict[str, tuple[CylinderRun, ...]] = {}
    joints: dict[str, tuple[MotionRun, ...]] = {}
    remarks, open_, driven, fed = list(data.remarks), list(data.open_questions), set(data.externally_driven), set(data.fed)
    judged_once = False
    for table in data.recordings:
        steps = np.diff(table.time)
        rate = 1.0 / max(float(np.median(steps)), 1e-9) if len(steps) else math.nan  # one sample, beside a gap
        fed |= fed_cylinders(table, data.rig, data.model)
        for whole in cylinder_runs(table, data.rig, data.model, data.links):
            run = from_decay_onset(whole) if whole.at_rest else whole
            if run is not whole:
                held = f"{run.time[0] - whole.time[0]:.3g} s"
                remarks.append(f"{table.name}: {run.cylinder} is held under pressure for its first {held}; judged from its fall on")
            unjudged = Unjudged(_FED, _RECORD_FED) if run.cylinder in fed else _why_no_gas(run, data.rig, rate)
            if unjudged is not None:
                open_.append(open_questions.of_gas(run.cylinder, table.name, unjudged))
            else:
                cylinders[run.cylinder] = (*cylinders.get(run.cylinder, ()), _thinned(run, data.rig))
                judged_once = True
            rod = rod_run(run, data.rig) if rate >= FEWEST_A_SECOND or _moves_slowly(table) else None
            if rod is not None:
                joints[f"rod of {run.cylinder}"] = (*joints.get(f"rod of {run.cylinder}", ()), rod)
        for name in data.rig.cylinders:
            if name not in cylinders and f"{name}.pressure_1" not in table and f"{name}.pressure_2" not in table:
                open_.append(open_questions.of_gas(name, table.name, _unmeasured(name)))
        if rate < FEWEST_A_SECOND and not _moves_slowly(table):
            slow = Unjudged(f"{rate:.3g} samples a second do not show how it moves", _faster(data.rig))
            names = [data.model.joint(j).name for j in range(data.model.njnt)]
            open_ += [open_questions.of_balance(name, table.name, slow) for name in names if f"{name}.position" in table]
            continue
        runs, reasons = motion_runs(table, data.rig, data.model, data.links)
        outside = externally_driven(table, data.rig, data.model, data.links) if runs else {}
        if are_recorded(table):
            outside = _driven_besides(runs, outside)
        moving = {motion.joint for motion in runs}
        reasons += [(joint, Unjudged(why, f"record {joint}.external_force as well")) for joint, why in outside.items() if joint in moving]
        driven |= set(outside)
        for motion in (motion for motion in runs if motion.joint not in outside):
            joints[motion.joint] = (*joints.get(motion.joint, ()), motion)
            judged_once = True
        open_ += [open_questions.of_balance(joint, table.name, unjudged) for joint, unjudged in reasons]
    if not judged_once:
        remarks.append("nothing in these recordings can be held against the rig")
    return replace(
        data, cylinders=cylinders, joints=joints, remarks=tuple(remarks), open_questions=tuple(open_),
        externally_driven=frozenset(driven), fed=frozenset(fed),
    )  # fmt: skip


def _thinned(run: CylinderRun, rig: Rig) -> CylinderRun:
    """Return a run on the clock that its gas is predicted on; forces tell of a chamber that was not measured sample for sample."""
    unmeasured = any(pressure is None for pressure in run.pressure) and not rig.cylinders[run.cylinder].single_acting
    return run if unmeasured else on_coarse_clock(run)


def _driven_besides(runs: Sequence[MotionRun], outside: Mapping[str, str]) -> dict[str, str]:
    """Return the joints that something moves beside the straps and the ground, whose forces are in the balance."""
    found = {joint: why for joint, why in outside.items() if joint not in {run.joint for run in runs}}
    for run in runs:
        there = run.judged
        arm = run.drive.arm[there]
        speed = run.kinematics.velocity[there] / np.where(np.abs(arm) > 0.0, arm, 1.0)
        why = external_power(run.time[there], run.demand[there], run.driving, speed)
        if why and run.joint in outside:
            found[run.joint] = why
    return found


def _faster(rig: Rig) -> str:
    """Return at what rate to record a machine, the same that `inspect` asks for."""
    rate = max([FEWEST_FOR_EVENTS, *(rate_for_gas(cylinder, rig) for cylinder in rig.cylinders.values())])
    return f"record at {rate:g} Hz or more"


def _why_no_gas(run: CylinderRun, rig: Rig, rate: float) -> Unjudged | None:
    """Return why the gas of a run cannot be judged, or None; `rate` in samples a second."""
    if run.length is None:
        why = "the position of its joint was not recorded, so its volumes are not known"
        return Unjudged(why, f"record the position of the joint that {run.cylinder} moves as well")
    if rate < FEWEST_A_SECOND and not (run.at_rest and _is_slow(run)):
        return Unjudged(f"{rate:.3g} samples a second do not show what the gas does", _faster(rig))
    if rate < FEWEST_FOR_EVENTS and not run.at_rest:
        return Unjudged(f"{rate:.3g} samples a second do not show what a valve or a moving piston does to the gas", _faster(rig))
    swings = [float(np.nanstd(p)) / max(noise, 1.0) for p, noise in zip(run.pressure, run.noise) if p is not None]
    if max(swings, default=0.0) < QUIET:
        return Unjudged("its pressures hardly change", "let the valve fill and vent it, or the piston move")
    if _open_to_supply(run):
        why = "its pressure is the supply's own: the line between them is open throughout"
        return Unjudged(why, "close the valve between them for some of the time")
    if not run.commanded and rig.cylinders[run.cylinder].valve_area > 0.0:
        return _uncommanded(run.cylinder, rig)
    if not run.commanded and run.supply is not None:
        return _uncommanded(run.cylinder, rig)
    return None


def _unmeasured(cylinder: str) -> Unjudged:
    return Unjudged("no pressure of it was recorded", f"record {cylinder}.pressure_1 and {cylinder}.pressure_2 as well")


def _uncommanded(cylinder: str, rig: Rig) -> Unjudged:
    columns = " and ".join(f"{cylinder}.{command}" for command in rig.cylinders[cylinder].needed_commands)
    return Unjudged("its valve command was not recorded", f"record {columns} as well")


def _is_slow(run: CylinderRun) -> bool:
    """Return whether a slow logger shows how the pressures of a run change."""
    return all(_changes_slowly(p, noise) for p, noise in zip(run.pressure, run.noise, strict=True) if p is not None)


def _moves_slowly(table: Recording) -> bool:
    """Return whether a slow logger shows how a machine moves; dry friction turns between any two samples."""
    return all(_changes_slowly(values, white_noise(values)) for key, values in table.columns.items() if key.endswith(".position"))


def _changes_slowly(values: NDArray[np.float64], noise: float) -> bool:
    """Return whether a signal changes by more than noise and a small share of all that it changes between two samples."""
    there = values[np.isfinite(values)]
    most = float(np.abs(np.diff(there)).max(initial=0.0))
    return most <= SLOW_CHANGE * (float(np.ptp(there)) if there.size else 0.0) + SLOW_NOISE * noise


def _open_to_supply(run: CylinderRun) -> bool:
    """Return whether every pressure of a run is the supply's, the same sensor given twice or a line that is never closed."""
    if run.supply is None:
        return False
    measured = [(p, noise) for p, noise in zip(run.pressure, run.noise, strict=True) if p is not None]
    return bool(measured) and all(
        float(np.nanstd(p - run.supply)) < max(SAME_SIGNAL * float(np.nanstd(p)), 2.0 * noise) for p, noise in measured
    )
