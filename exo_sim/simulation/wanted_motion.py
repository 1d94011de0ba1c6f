"""A recorded motion as what a machine is to do: smooth positions of its joints on the simulation's steps, and forces from outside."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RecordingError, nearest
from exo_sim.machine.linkage import STROKE_TOLERANCE, Linkage, moment_row
from exo_sim.recording.filters import smoothed
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

Array = NDArray[np.float64]

#: A motion is smoothed over this time [s], or five of its own samples: what a machine on gas cannot follow is not asked of it.
SMOOTHING = 0.05
#: The longest gap of a position [s], and the longest motion [s] and number of steps.
LONGEST_GAP, MOST_STEPS = 0.5, 20_000_000
#: Moments of a motion at which strokes are looked at.
_LOOKED_AT = 500


@dataclass(frozen=True)
class WantedMotion:
    """What the joints are to do, n steps.

    Attributes:
        name: What to call it.
        joints: Of which a position was recorded, m of them.
        time: [s] from 0, shape (n,).
        position, velocity, acceleration: Shape (n, m).
        external: Joint to the force from outside [N m, N], shape (n,).
    """

    name: str
    joints: tuple[str, ...]
    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    external: Mapping[str, Array]

    def at(self, time: float) -> dict[str, tuple[float, float]]:
        """Return position and velocity wanted of each joint at a time [s]."""
        i = min(max(round(time / (self.time[1] - self.time[0])), 0), len(self.time) - 1)
        return {name: (float(self.position[i, j]), float(self.velocity[i, j])) for j, name in enumerate(self.joints)}


def wanted(recording: Recording, rig: Rig, model: mujoco.MjModel, links: tuple[Linkage, ...]) -> WantedMotion:
    """Return a recording as a motion for a machine.

    Raises:
        RecordingError: no position of a joint that a cylinder drives, a wrong unit, a gap, or a start outside the joint's range.
    """
    names = [model.joint(j).name for j in range(model.njnt)]
    scalar = [n for j, n in enumerate(names) if model.jnt_type[j] in (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))]
    recorded = [key.removesuffix(".position") for key in recording.columns if key.endswith(".position")]
    for name in recorded:
        if name not in scalar:
            raise RecordingError(f'{recording.name}: "{name}.position" is of no joint of {rig.model.name}{nearest(name, scalar)}')
    driven = list(dict.fromkeys(link.joint for link in links))
    missing = [name for name in driven if name not in recorded]
    if missing:
        unit = "rad" if model.joint(missing[0]).type[0] == mujoco.mjtJoint.mjJNT_HINGE else "m"
        raise RecordingError(
            f'{recording.name}: no column "{missing[0]}.position [{unit}]"; a motion has the position of every joint that a cylinder '
            f"of {rig.name} drives: {', '.join(driven)}"
        )
    joints = tuple(name for name in scalar if name in recorded)
    step = float(model.opt.timestep)
    count = int((recording.time[-1] - recording.time[0]) / step + 1e-9) + 1
    if not 10 <= count <= MOST_STEPS:
        raise RecordingError(f"{recording.name}: lasts {recording.duration:g} s, {count} steps of {step:g} s; write 10 to {MOST_STEPS}")
    time: Array = step * np.arange(count, dtype=np.float64)
    usual = float(np.median(np.diff(recording.time)))
    columns = []
    for name in joints:
        _check(recording, f"{name}.position", "rad" if model.joint(name).type[0] == mujoco.mjtJoint.mjJNT_HINGE else "m")
        motion = smoothed(recording.time, recording[f"{name}.position"], max(SMOOTHING, 5.0 * usual))
        columns.append([np.interp(time, recording.time - recording.time[0], each) for each in motion])
        _check_range(recording, model, name, columns[-1][0])
    position, velocity, acceleration = (np.stack([column[k] for column in columns], axis=1) for k in range(3))
    return WantedMotion(recording.name, joints, time, position, velocity, acceleration, _external(recording, model, rig, scalar, time))


def _external(recording: Recording, model: mujoco.MjModel, rig: Rig, joints: list[str], time: Array) -> dict[str, Array]:
    out = {}
    for key in recording.columns:
        if not key.endswith(".external_force"):
            continue
        name = key.removesuffix(".external_force")
        if name not in joints:
            raise RecordingError(f'{recording.name}: "{key}" acts on no joint of {rig.model.name}{nearest(name, joints)}')
        _check(recording, key, "N*m" if model.joint(name).type[0] == mujoco.mjtJoint.mjJNT_HINGE else "N")
        good = np.isfinite(recording[key])
        out[name] = np.interp(time, recording.time[good] - recording.time[0], recording[key][good])
    return out


def _check(recording: Recording, key: str, unit: str) -> None:
    if recording.units[key] != unit:
        raise RecordingError(f'{recording.name}: "{key}" is in {recording.units[key]}, that joint has it in {unit}')
    seen = recording.time[np.isfinite(recording[key])]
    gaps = np.diff(np.concatenate([recording.time[:1], seen, recording.time[-1:]]))
    if gaps.max() > max(LONGEST_GAP, 3.0 * float(np.median(np.diff(recording.time)))):
        at = float(np.concatenate([recording.time[:1], seen])[int(np.argmax(gaps))])
        raise RecordingError(f'{recording.name}: "{key}" has no samples for {gaps.max():.2f} s from {at:.2f} s on; cut the motion there')


def _check_range(recording: Recording, model: mujoco.MjModel, name: str, values: Array) -> None:
    joint = model.joint(name)
    if not model.jnt_limited[joint.id]:
        return
    low, high = model.jnt_range[joint.id]
    slack = 0.05 * (high - low)
    if values.min() < low - slack or values.max() > high + slack:
        raise RecordingError(
            f'{recording.name}: "{name}.position" goes from {values.min():.4g} to {values.max():.4g}, the joint from {low:.4g} '
            f"to {high:.4g}; is it the same zero and sign?"
        )


def check_reach(rig: Rig, model: mujoco.MjModel, motion: WantedMotion, links: tuple[Linkage, ...]) -> None:
    """Refuse a motion that a piston's stroke does not reach, or in which a cylinder has no lever.

    Raises:
        RecordingError: the message names cylinder, joint, time and lengths.
    """
    data = mujoco.MjData(model)
    addresses = [int(model.joint(name).qposadr[0]) for name in motion.joints]
    for i in range(0, len(motion.time), max(1, len(motion.time) // _LOOKED_AT)):
        data.qpos[addresses] = motion.position[i]
        mujoco.mj_forward(model, data)
        for link in links:
            cylinder = rig.cylinders[link.cylinder]
            x = float(data.actuator_length[link.actuator]) - cylinder.retracted_length
            at = f'{motion.name}: at {motion.time[i]:.2f} s joint "{link.joint}"'
            if not -STROKE_TOLERANCE <= x <= cylinder.stroke + STROKE_TOLERANCE:
                raise RecordingError(
                    f"{at} puts the piston of {link.cylinder} at X = {1e3 * x:.1f} mm, its stroke is {1e3 * cylinder.stroke:.1f} mm; "
                    f"are sign and zero right, and retracted_length in {rig.path.name}?"
                )
            if abs(float(moment_row(model, data, link.actuator)[link.dof])) < 1e-4:
                raise RecordingError(f"{at} leaves cylinder {link.cylinder} no lever; move an attachment point, or the motion")
