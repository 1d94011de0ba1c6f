"""What one recording says of each cylinder and joint, on its own clock, ready to cut the plant with."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.filters import POSITION_SMOOTHING, smoothed, white_noise
from exo_sim.machine.linkage import Linkage, moment_row
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

Array = NDArray[np.float64]

#: Where the clock jumps by more than this many usual steps no prediction runs across.
JUMP = 20.0
#: ... nor across a hole in a channel that is longer than this [s].
HOLE = 0.03


@dataclass
class CylinderRun:
    """One cylinder in one recording; every array has shape (n,), NaN where a sample is missing.

    Attributes:
        time: [s].
        command: Valve command, -1 to 1; zero where none was recorded.
        length: Piston position X as the joint has it [m], smoothed; None where no position was recorded.
        speed: Its rate [m/s].
        pressure: Measured chamber pressures [Pa], each or None.
        supply, exhaust: Measured, or None: then the rig's constants.
        supply_temperature: Measured, or None.
        force: Load cell on the rod [N], or None.
        commanded: Whether a valve command was recorded.
        noise: Sensor noise of each pressure [Pa].
        breaks: Indices at which a new stretch begins.
        begun: Pressure at the first sample of a chamber that was not measured, by the balance of forces [Pa]; NaN where unknown.
        jitter: Standard deviation of the white noise that `length` had before it was smoothed [m].
    """

    recording: str
    cylinder: str
    time: Array
    command: Array
    length: Array | None
    speed: Array | None
    pressure: tuple[Array | None, Array | None]
    supply: Array | None
    exhaust: Array | None
    supply_temperature: Array | None
    force: Array | None
    commanded: bool
    noise: tuple[float, float]
    breaks: tuple[int, ...]
    begun: tuple[float, float] = (math.nan, math.nan)
    jitter: float = 0.0

    @property
    def rests(self) -> bool:
        """Whether neither the valve nor the piston ever moves: what the gas does then is slow."""
        return float(np.ptp(self.command)) < 1e-3 and (self.length is None or float(np.ptp(self.length)) < 1e-4)

    def until(self, stop: int) -> CylinderRun:
        """Return the first `stop` samples as a run of their own."""
        return self.part(0, stop)

    def part(self, start: int, stop: int) -> CylinderRun:
        """Return the samples from `start` to before `stop` as a run of their own."""

        def cut(values: Array | None) -> Array | None:
            return None if values is None else values[start:stop]

        return replace(
            self, time=self.time[start:stop], command=self.command[start:stop], length=cut(self.length), speed=cut(self.speed),
            pressure=(cut(self.pressure[0]), cut(self.pressure[1])), supply=cut(self.supply), exhaust=cut(self.exhaust),
            supply_temperature=cut(self.supply_temperature), force=cut(self.force),
            breaks=(0, *(b - start for b in self.breaks if start < b < stop)),
            begun=self.begun if start == 0 else (math.nan, math.nan),
        )  # fmt: skip


@dataclass
class JointRun:
    """One joint in one recording: smoothed position, velocity, acceleration, shape (n,), in m or rad."""

    recording: str
    joint: str
    time: Array
    raw: Array
    position: Array
    velocity: Array
    acceleration: Array
    noise: float
    breaks: tuple[int, ...] = field(default=())


def breaks_of(time: Array) -> tuple[int, ...]:
    """Return the indices at which the clock has jumped, 0 first."""
    step = np.diff(time)
    usual = float(np.median(step)) if step.size else 1.0
    return (0, *(int(i) + 1 for i in np.flatnonzero(step > JUMP * usual)))


def gaps_of(time: Array, *channels: Array | None) -> tuple[int, ...]:
    """Return the indices at which a stretch begins: jumps of the clock, and both ends of every hole in a channel."""
    edges = set(breaks_of(time))
    least = max(3, int(HOLE / max(float(np.median(np.diff(time))), 1e-9))) if len(time) > 1 else 3
    for values in channels:
        if values is None:
            continue
        bad = np.concatenate([[0], (~np.isfinite(values)).astype(int), [0]])
        turns = np.flatnonzero(np.diff(bad))
        for begin, end in zip(turns[::2], turns[1::2], strict=True):
            if end - begin >= least:
                edges |= {int(begin), int(end)}
    return tuple(sorted(edge for edge in edges if edge < len(time)))


def joint_run(recording: Recording, joint: str, seconds: float = POSITION_SMOOTHING) -> JointRun | None:
    """Return a joint's motion, or None where its position was not recorded."""
    raw = recording.get(f"{joint}.position")
    if raw is None or np.isfinite(raw).sum() < 5:
        return None
    position, velocity, acceleration = smoothed(recording.time, raw, seconds)
    return JointRun(
        recording.name,
        joint,
        recording.time,
        raw,
        position,
        velocity,
        acceleration,
        white_noise(raw),
        breaks_of(recording.time),
    )


def lengths(
    recording: Recording, rig: Rig, model: mujoco.MjModel, links: tuple[Linkage, ...]
) -> dict[str, tuple[Array, Array, float]]:
    """Return X and dX/dt of every cylinder whose joints were recorded, shape (n,) each, and what noise X had before it was smoothed.

    Through MuJoCo's kinematics.
    """
    moves = {}
    for joint in range(model.njnt):
        name = model.joint(joint).name
        run = joint_run(recording, name)
        if run is not None:
            moves[joint] = run
    found: dict[str, tuple[Array, Array, float]] = {}
    data = mujoco.MjData(model)
    time = recording.time
    for link in links:
        joint = int(model.dof_jntid[link.dof])
        if joint not in moves:
            continue
        cylinder = rig.cylinders[link.cylinder]
        run = moves[joint]
        if model.actuator_trntype[link.actuator] == int(mujoco.mjtTrn.mjTRN_JOINT):
            gear = float(model.actuator_gear[link.actuator, 0])
            found[link.cylinder] = gear * run.position - cylinder.retracted_length, gear * run.velocity, abs(gear) * run.noise
            continue
        # a tendon across one joint: its length is a smooth function of that angle, tabulated finely
        low, high = float(np.nanmin(run.position)), float(np.nanmax(run.position))
        angles = np.linspace(low - 1e-6, high + 1e-6, 401)
        table, arms = np.empty(401), np.empty(401)
        for k, angle in enumerate(angles):
            data.qpos[:] = model.qpos0
            data.qpos[model.jnt_qposadr[joint]] = angle
            mujoco.mj_forward(model, data)
            table[k] = data.actuator_length[link.actuator]
            arms[k] = moment_row(model, data, link.actuator)[link.dof]
        length = np.interp(run.position, angles, table) - cylinder.retracted_length
        arm = np.interp(run.position, angles, arms)
        found[link.cylinder] = length, arm * run.velocity, float(np.median(np.abs(arm))) * run.noise
    assert all(len(x) == len(time) for x, _, _ in found.values())
    return found


def cylinder_runs(
    recording: Recording, rig: Rig, model: mujoco.MjModel, links: tuple[Linkage, ...]
) -> list[CylinderRun]:
    """Return one run for every cylinder of the rig of which the recording holds a pressure."""
    known = lengths(recording, rig, model, links)
    runs = []
    for name in rig.cylinders:
        p_1, p_2 = recording.get(f"{name}.pressure_1"), recording.get(f"{name}.pressure_2")
        if p_1 is None and p_2 is None:
            continue
        command = recording.get(f"{name}.valve_command")
        length, speed, jitter = known.get(name, (None, None, 0.0))
        held = np.zeros_like(recording.time) if command is None else np.clip(_held(command), -1.0, 1.0)
        runs.append(
            CylinderRun(
                recording.name,
                name,
                recording.time,
                held,
                length,
                speed,
                (p_1, p_2),
                _bridged(recording, "supply.pressure"),
                _bridged(recording, "exhaust.pressure"),
                _bridged(recording, "supply.temperature"),
                recording.get(f"{name}.force"),
                command is not None,
                (white_noise(p_1), white_noise(p_2)),
                gaps_of(recording.time, p_1, p_2, _position(recording, name, links)),
                jitter=jitter,
            )  # fmt: skip
        )
    return runs


def _position(recording: Recording, cylinder: str, links: tuple[Linkage, ...]) -> Array | None:
    joint = next((link.joint for link in links if link.cylinder == cylinder), "")
    return recording.get(f"{joint}.position")


def _held(values: Array) -> Array:
    """Return values with missing samples replaced by the last good one."""
    good = np.isfinite(values)
    if good.all():
        return values
    index = np.maximum.accumulate(np.where(good, np.arange(len(values)), -1))
    return np.where(index >= 0, values[np.maximum(index, 0)], 0.0)


def _bridged(recording: Recording, key: str) -> Array | None:
    """Return a slow channel with missing samples bridged and its jitter smoothed, or None."""
    values = recording.get(key)
    if values is None or np.isfinite(values).sum() < 5:
        return None
    return smoothed(recording.time, values, 0.02)[0]
