"""What one recording says of each cylinder and joint, on its own clock, ready to cut the plant with."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.signal import savgol_coeffs, savgol_filter

from exo_sim.machine.linkage import Linkage, moment_row
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

Array = NDArray[np.float64]

#: Position is smoothed over this time: a mass on gas does not move faster, sensors jitter faster [s].
POSITION_SMOOTHING = 0.015
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


def smooth_window(time: Array, seconds: float = POSITION_SMOOTHING) -> int:
    """Return an odd number of samples that spans about `seconds`, at least 5."""
    usual = float(np.median(np.diff(time)))
    return max(5, 2 * int(round(0.5 * seconds / usual)) + 1)


def smoothed(time: Array, values: Array, seconds: float = POSITION_SMOOTHING) -> tuple[Array, Array, Array]:
    """Return values, first and second derivative by local cubics, shape (n,) each; missing samples are bridged."""
    if not np.isfinite(values).any():
        return values, values, values
    filled, grid, even, usual = _evenly(time, values)
    window = min(smooth_window(time, seconds), 2 * ((len(grid) - 1) // 2) + 1)
    if window < 5:
        return filled, np.gradient(filled, time), np.zeros_like(filled)
    out = [savgol_filter(grid, window, 3, deriv=d, delta=usual, mode="interp") for d in range(3)]
    return _back(time, even, out[0]), _back(time, even, out[1]), _back(time, even, out[2])


def led(time: Array, values: Array, seconds: float) -> tuple[Array, Array, Array]:
    """Return values, first and second derivative, shape (n,) each, all behind the very same filter: a Gaussian of `seconds`' width.

    What a balance of forces needs: derivatives of the smoothed signal, so that nothing but the same smoothing stands on its two sides.
    """
    if not np.isfinite(values).any():
        return values, values, values
    _, grid, even, usual = _evenly(time, values)
    quiet = _gaussian(grid, seconds, usual)
    rate = np.gradient(quiet, usual)
    # differences of the smoothed signal: a cut-off derivative kernel would answer a constant
    bend = np.zeros_like(quiet)
    bend[1:-1] = (quiet[2:] - 2.0 * quiet[1:-1] + quiet[:-2]) / usual**2
    return _back(time, even, quiet), _back(time, even, rate), _back(time, even, bend)


def quieted(time: Array, values: Array, seconds: float) -> Array:
    """Return the values alone of what `led` returns, shape (n,)."""
    if not np.isfinite(values).any():
        return values
    _, grid, even, usual = _evenly(time, values)
    return _back(time, even, _gaussian(grid, seconds, usual))


def _gaussian(grid: Array, seconds: float, usual: float) -> Array:
    return gaussian_filter1d(grid, min(gaussian_width(seconds) / usual, 0.02 * len(grid)), mode="nearest")


def _evenly(time: Array, values: Array) -> tuple[Array, Array, Array | None, float]:
    """Return values with gaps bridged, the same on an even clock, that clock (None where it is the own one), and its step [s]."""
    bad = ~np.isfinite(values)
    filled = np.interp(time, time[~bad], values[~bad]) if bad.any() else values
    usual = float(np.median(np.diff(time)))
    even = np.arange(time[0], time[-1] + 0.5 * usual, usual)
    if len(even) == len(time) and np.allclose(even, time, atol=0.02 * usual):
        return filled, filled, None, usual
    return filled, np.interp(even, time, filled), even, usual


def _back(time: Array, even: Array | None, values: Array) -> Array:
    return values if even is None else np.interp(time, even, values)


def gaussian_width(seconds: float) -> float:
    """Return the standard deviation [s] of the Gaussian that smooths over about `seconds`."""
    return seconds / 4.0


def left_of_noise(order: int, seconds: float, step: float) -> float:
    """Return what `led` leaves of white noise of size 1 in a derivative of this order."""
    s = gaussian_width(seconds)
    power = (1.0 / (2.0 * s), 1.0 / (4.0 * s**3), 3.0 / (8.0 * s**5))[order] / np.sqrt(np.pi)
    return float(np.sqrt(step * power))


def white_noise(values: Array | None) -> float:
    """Return the standard deviation of a channel's white noise, from its fourth differences (robust, blind to smooth signals)."""
    if values is None:
        return 0.0
    good = values[np.isfinite(values)]
    if good.size < 20:
        return 0.0
    fourth = np.diff(good, 4) / np.sqrt(70.0)
    spread = 1.4826 * float(np.median(np.abs(fourth - np.median(fourth))))
    if spread > 0.0:
        return spread
    steps = np.abs(np.diff(good))
    steps = steps[steps > 0.0]
    return float(steps.min()) / np.sqrt(12.0) if steps.size else 0.0


def start_filter(points: int) -> Array:
    """Return weights that estimate a value at the start of `points` samples by a local parabola."""
    return savgol_coeffs(points, 2, pos=0, use="dot")


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
) -> dict[str, tuple[Array, Array]]:
    """Return X and dX/dt of every cylinder whose joints were recorded, through MuJoCo's kinematics, shape (n,) each."""
    moves = {}
    for joint in range(model.njnt):
        name = model.joint(joint).name
        run = joint_run(recording, name)
        if run is not None:
            moves[joint] = run
    found: dict[str, tuple[Array, Array]] = {}
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
            found[link.cylinder] = gear * run.position - cylinder.retracted_length, gear * run.velocity
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
        found[link.cylinder] = length, np.interp(run.position, angles, arms) * run.velocity
    assert all(len(x) == len(time) for x, _ in found.values())
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
        length, speed = known.get(name, (None, None))
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
