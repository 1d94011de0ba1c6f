"""Recordings and rig put side by side: what can be judged, what cannot, and which sensors must not be believed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import mujoco
import numpy as np

from exo_sim import recording as recordings
from exo_sim.diagnosis.motion_cut import MotionRun, motion_runs
from exo_sim.diagnosis.observed import CylinderRun, cylinder_runs
from exo_sim.diagnosis.replay_inputs import led_against, led_from_outside
from exo_sim.diagnosis.result import Estimate, Finding, OpenQuestion
from exo_sim.diagnosis.rod_cut import rod_run
from exo_sim.diagnosis.shut_in import from_the_fall
from exo_sim.errors import RecordingError, nearest
from exo_sim.machine.linkage import Linkage, linkages
from exo_sim.machine.load import load
from exo_sim.recording.health import Facts, blanked, check
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig, read
from exo_sim.simulation.sensors import seen_through

#: Fewer samples a second than this do not show what gas does.
FEWEST_A_SECOND = 8.0
#: ... of a valve that works or a piston that moves, this many.
FEWEST_FOR_EVENTS = 25.0
#: A pressure that swings less than this, in units of its noise, says nothing.
QUIET = 3.0
_FAULTS = {
    "stuck": ("sensor_stuck", "The sensor is stuck for part of the time."),
    "clipped": ("sensor_clipped", "The sensor runs into the end of its range."),
    "gauge": ("sensor_bias", "The sensor reads gauge pressure where absolute was promised."),
    "unit": ("sensor_scale", "The column cannot be in the unit that its header names."),
    "range": ("sensor_scale", "The column leaves the range that its quantity can have."),
    "inconsistent": ("sensor_scale", "The velocity is not the rate of the position."),
    "constant": ("sensor_stuck", "The sensor shows one value while the machine moves."),
}


_WRONG_SIGN = Estimate(-1.0, "1", -1.0, -1.0)


@dataclass
class Case:
    """Everything that was handed in, sorted.

    Attributes:
        rig, model, links: The machine.
        recordings: Cleaned of what must not be believed.
        cylinders: Runs by cylinder that the gas cut can judge.
        joints: Runs that the motion cut can judge, by joint, or as "rod of CYLINDER" where that carries a load cell.
        sensors: Faults found before any physics was asked.
        remarks: Plain sentences about clocks and sensors.
        open: Questions that cannot be judged.
        led: Joints that somebody led or held unmeasured.
        as_read: The recordings as they were handed in.
    """

    rig: Rig
    model: mujoco.MjModel
    links: tuple[Linkage, ...]
    recordings: list[Recording]
    cylinders: dict[str, list[CylinderRun]] = field(default_factory=dict)
    joints: dict[str, list[MotionRun]] = field(default_factory=dict)
    sensors: list[Finding] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    open: list[OpenQuestion] = field(default_factory=list)
    led: set[str] = field(default_factory=set)
    as_read: list[Recording] = field(default_factory=list)

    def copy(self) -> Case:
        """Return a case that may be sorted anew without touching this one."""
        return replace(
            self, cylinders=dict(self.cylinders), joints=dict(self.joints), sensors=list(self.sensors), remarks=list(self.remarks),
            open=list(self.open), led=set(self.led),
        )  # fmt: skip

    def joint_of(self, cylinder: str) -> str:
        """Return the joint that a cylinder drives."""
        return next(link.joint for link in self.links if link.cylinder == cylinder)

    def table(self, name: str) -> Recording:
        """Return a recording by its name."""
        return next(table for table in self.recordings if table.name == name)


def gather(paths: Sequence[Path], rig_path: Path, column_map: Path | None = None) -> Case:
    """Read recordings and rig.

    Raises:
        RecordingError, RigError, ModelError: one line each; nothing usable, or columns of another machine.
    """
    rig = read(rig_path)
    model = load(rig)
    case = Case(rig, model, linkages(rig, model), [])
    taken: set[str] = set()
    for path in paths:
        reading = recordings.read(path, column_map)
        name = reading.recording.name
        while name in taken:
            name += "'"
        taken.add(name)
        table = replace(reading.recording, name=name)
        _belongs(table, path, rig, model)
        case.remarks += [finding.says for finding in reading.findings if finding.severity != "info"]
        case.as_read.append(table)
        table, mended = seen_through(table, rig)
        case.remarks += [f"{table.name}: {column} was put right by what the rig says of its sensor" for column in mended]
        case.recordings.append(_trusted(table, case))
    _sort(case)
    return case


def _belongs(table: Recording, path: Path, rig: Rig, model: mujoco.MjModel) -> None:
    known = {*rig.cylinders, *(model.joint(j).name for j in range(model.njnt))}
    parts = [part for part in table.parts() if part in known]
    if not parts:
        others = [part for part in table.parts() if part not in ("supply", "exhaust", "gait")]
        asked = others[0] if others else "any part"
        raise RecordingError(
            f'"{path}": no column belongs to {rig.path}: "{asked}" is none of its parts{nearest(asked, known)}'
        )
    silent = [name for name in rig.cylinders if name not in table.parts()]
    if rig.cylinders and len(silent) == len(rig.cylinders) and not any(k.endswith(".position") for k in table.columns):
        raise RecordingError(
            f'"{path}": never mentions a cylinder of {rig.path} ({", ".join(silent)}): is it another machine\'s?'
        )


def _trusted(table: Recording, case: Case) -> Recording:
    """Return the recording without what its sensors cannot have seen; say what was taken out."""
    rig = case.rig
    columns = dict(table.columns)
    for finding in check(table, Facts.of(rig, case.model)):
        if finding.severity == "info":
            continue
        case.remarks.append(finding.says)
        if finding.severity != "fault" or finding.column not in columns:
            continue
        values = columns[finding.column]
        name, says = _FAULTS.get(finding.kind, ("sensor_fault", finding.says))
        parameters = {}
        if finding.kind == "gauge":
            values = values + rig.environment.pressure
            off = -rig.environment.pressure
            parameters = {"value": Estimate(off, "Pa", off - 2e3, off + 2e3)}
        else:
            values = blanked(values, finding)
        columns[finding.column] = values
        case.sensors.append(Finding(name, finding.column, "sensor", f"{says} {finding.says}", parameters, 10.0, 0.0))
    return replace(table, columns={key: values for key, values in columns.items() if np.isfinite(values).sum() > 10})


def _sort(case: Case) -> None:
    """Say which balance can be judged, and which question stays open."""
    judged_once = False
    for table in case.recordings:
        rate = 1.0 / max(float(np.median(np.diff(table.time))), 1e-9)
        for run in cylinder_runs(table, case.rig, case.model, case.links):
            late = from_the_fall(run) if run.rests else run
            if late is not run:
                held = f"{late.time[0] - run.time[0]:.3g} s"
                case.remarks.append(f"{table.name}: {run.cylinder} is held under pressure for its first {held}; judged from its fall on")
                run = late
            why = _no_gas(run, case.rig, rate)
            if why:
                case.open.append(
                    OpenQuestion(f"the gas of {run.cylinder} in {table.name}", ("gas and valve effects",), why)
                )
            else:
                case.cylinders.setdefault(run.cylinder, []).append(run)
                judged_once = True
            rod = rod_run(run, case.rig) if rate >= FEWEST_A_SECOND else None
            if rod is not None:
                case.joints.setdefault(f"rod of {run.cylinder}", []).append(rod)
        mentioned = {run.cylinder for runs in case.cylinders.values() for run in runs}
        for name in case.rig.cylinders:
            if name not in mentioned and f"{name}.pressure_1" not in table and f"{name}.pressure_2" not in table:
                case.open.append(
                    OpenQuestion(
                        f"the gas of {name} in {table.name}",
                        ("gas and valve effects",),
                        "no pressure of it was recorded",
                    )
                )
        if rate < FEWEST_A_SECOND:
            continue
        runs, reasons = motion_runs(table, case.rig, case.model, case.links)
        led = led_from_outside(table, case.rig, case.model, case.links) if runs else {}
        reasons += [(joint, why) for joint, why in led.items() if joint in {run.joint for run in runs}]
        case.led |= set(led)
        for motion in (run for run in runs if run.joint not in led):
            case.joints.setdefault(motion.joint, []).append(motion)
            judged_once = True
        case.open += [_no_balance(joint, table.name, why) for joint, why in reasons]
    if not judged_once:
        case.remarks.append("nothing in these recordings can be held against the rig")


def balance_asked(joint: str, recording: str) -> str:
    """Return the question that a balance of forces answers, in words."""
    return f"the balance of forces at {joint} in {recording}"


def _no_balance(joint: str, recording: str, why: str) -> OpenQuestion:
    return OpenQuestion(balance_asked(joint, recording), ("friction, load and joint effects",), why)


def put_right(case: Case, joints: Mapping[str, Sequence[MotionRun]]) -> None:
    """Take over runs of the motion cut whose pressures were put right; what then proves to be led from outside stays open."""
    for joint, runs in joints.items():
        kept = []
        for run, before in zip(runs, case.joints[joint], strict=True):
            needed = run.inertial - run.passive
            speed = run.velocity / np.where(np.abs(run.arm) > 1e-6, run.arm, 1.0)
            unsure = run is not before and run.weighs and not run.external_recorded
            why = led_against(run.time, needed, run.drive, speed) if unsure else ""
            if why:
                case.led.add(run.joint)
                case.open.append(_no_balance(run.joint, run.recording, why))
            else:
                kept.append(run)
        case.joints[joint] = kept
    case.joints = {joint: runs for joint, runs in case.joints.items() if runs}


def turned_round(cylinder: str) -> Finding:
    """Return the finding of a valve command with the wrong sign."""
    says = "The valve command has the wrong sign: its opposite moves the pressures as recorded."
    return Finding(
        "sensor_scale",
        f"{cylinder}.valve_command",
        "sensor",
        says,
        {"factor": _WRONG_SIGN},
        100.0,
        0.9,
    )


def is_turned_round(finding: Finding) -> bool:
    """Say whether a finding is of a valve command with the wrong sign."""
    return finding.where.endswith(".valve_command") and finding.parameters.get("factor") == _WRONG_SIGN


def _no_gas(run: CylinderRun, rig: Rig, rate: float) -> str:
    if run.length is None:
        return "the position of its joint was not recorded, so its volumes are not known"
    if rate < FEWEST_A_SECOND:
        return f"{rate:.3g} samples a second do not show what the gas does"
    still = float(np.ptp(run.length)) < 1e-4 and float(np.ptp(run.command)) < 1e-3
    if rate < FEWEST_FOR_EVENTS and not still:
        return f"{rate:.3g} samples a second do not show what a valve or a moving piston does to the gas"
    swings = [float(np.nanstd(p)) / max(noise, 1.0) for p, noise in zip(run.pressure, run.noise) if p is not None]
    if max(swings, default=0.0) < QUIET:
        return "its pressures hardly change"
    if not run.commanded and rig.cylinders[run.cylinder].valve_area > 0.0:
        return "its valve command was not recorded"
    if not run.commanded and run.supply is not None:
        return "its valve command was not recorded"
    return ""
