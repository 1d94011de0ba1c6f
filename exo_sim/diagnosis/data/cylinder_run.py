"""The signals of one cylinder in one recording, on the recording's clock or a coarser one (`coarse_clock.py`)."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.computed_columns import was_computed
from exo_sim.diagnosis.policy.recordings import FEWEST_OF_CHANNEL, STILL_COMMAND, STILL_LENGTH, SWITCHED_OVER
from exo_sim.diagnosis.policy.regimes import SMALL_COMMAND
from exo_sim.machine.linkage import Linkage, moment_row
from exo_sim.recording.filters import forward_filled, smoothed
from exo_sim.recording.noise import white_noise
from exo_sim.recording.table import Recording
from exo_sim.recording.windows import holes, mended_at, stretch_starts
from exo_sim.rig import Rig

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CylinderRun:
    """One cylinder in one recording; every array has shape (n,), NaN where a sample is missing.

    Attributes:
        recording, cylinder: Their names.
        time: [s].
        command: Valve command, -1 to 1, towards chamber 1; zero where none was recorded.
        length: Piston position X as the joint has it [m], smoothed; None where no position was recorded.
        speed: Its rate [m/s].
        pressure: Measured chamber pressures [Pa], each or None.
        supply, exhaust: Measured, or None: then the rig's constants.
        supply_temperature: Measured, or None.
        force: Load cell on the rod [N], or None.
        commanded: Whether a valve command was recorded.
        noise: Standard deviation of the white noise of each pressure [Pa].
        breaks: Indices at which a new stretch begins.
        initial: Pressure at the first sample of a chamber that was not measured, from the balance of forces [Pa]; NaN where unknown.
        position_noise: Standard deviation of the white noise of `length` before it was smoothed [m].
        command_2: Towards chamber 2 where the valve has independent edges; None where one spool serves both.
        sampled: Whether commands are samples of a quicker loop, and not what the valve got until the next.
        computed: Whether the recording was computed, or smoothed, and not just measured.
        settled: Whether the gas is known to be as warm as its walls where the run begins: it was held there before.
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
    initial: tuple[float, float] = (math.nan, math.nan)
    position_noise: float = 0.0
    command_2: Array | None = None
    settled: bool = False
    sampled: bool = False
    computed: bool = False

    def towards(self, side: int) -> Array:
        """Return the command that opens chamber 1 (side 0) or 2 (side 1) to the supply where it is above zero, shape (n,)."""
        if side == 0:
            return self.command
        return -self.command if self.command_2 is None else self.command_2

    @property
    def turned(self) -> CylinderRun:
        """The same run with commands of the other sign."""
        return replace(self, command=-self.command, command_2=None if self.command_2 is None else -self.command_2)

    @property
    def at_rest(self) -> bool:
        """Whether neither the valve nor the piston ever moves: the gas then changes slowly."""
        held = all(float(np.ptp(self.towards(side))) < STILL_COMMAND for side in (0, 1))
        return held and (self.length is None or float(np.ptp(self.length)) < STILL_LENGTH)

    @property
    def stays_open(self) -> bool:
        """Whether one command holds the valve open all the time: nothing then says how it opens, or what else gas passes with it."""
        held = [self.towards(side) for side in (0, 1)]
        return self.commanded and all(float(np.ptp(u)) < STILL_COMMAND and abs(float(u[0])) > SMALL_COMMAND for u in held)

    @property
    def is_switched(self) -> bool:
        """Whether the commands do nothing but switch the valve over: none of them ever changes by little."""
        changes = np.concatenate([np.abs(np.diff(self.towards(side))) for side in (0, 1)])
        changes = changes[changes > 0.0]
        return bool(self.commanded and changes.size > 0 and changes.min() > SWITCHED_OVER)

    @property
    def changes_sides(self) -> bool:
        """Whether a command ever switches the valve straight from one side to the other."""
        sides = (self.towards(side) for side in (0, 1))
        return self.commanded and any(bool(((u[1:] * u[:-1] < 0.0) & (np.abs(np.diff(u)) > SWITCHED_OVER)).any()) for u in sides)

    @property
    def is_never_partly_open(self) -> bool:
        """Whether the commands hold the valve closed or at its ends and nowhere between."""
        sizes = np.abs(np.concatenate([self.towards(side) for side in (0, 1)]))
        return self.commanded and bool(((sizes < SMALL_COMMAND) | (sizes > 1.0 - SMALL_COMMAND)).all())

    @property
    def moves(self) -> bool:
        """Whether the piston moves, as far as its position was recorded."""
        return self.length is not None and float(np.ptp(self.length)) > STILL_LENGTH

    def until(self, stop: int) -> CylinderRun:
        """Return the first `stop` samples as a run of their own."""
        return self.part(0, stop)

    def part(self, start: int, stop: int) -> CylinderRun:
        """Return the samples from `start` to before `stop` as a run of their own."""
        return self._chosen(slice(start, stop), (0, *(b - start for b in self.breaks if start < b < stop)), start == 0)

    def at(self, samples: NDArray[np.int64], breaks: tuple[int, ...]) -> CylinderRun:
        """Return some samples as a run of their own, where it breaks as indices among them."""
        return self._chosen(samples, breaks, bool(samples[0] == 0))

    def _chosen(self, samples: slice | NDArray[np.int64], breaks: tuple[int, ...], from_the_start: bool) -> CylinderRun:
        def cut(values: Array | None) -> Array | None:
            return None if values is None else values[samples]

        return replace(
            self, time=self.time[samples], command=self.command[samples], length=cut(self.length), speed=cut(self.speed),
            pressure=(cut(self.pressure[0]), cut(self.pressure[1])), supply=cut(self.supply), exhaust=cut(self.exhaust),
            supply_temperature=cut(self.supply_temperature), force=cut(self.force), command_2=cut(self.command_2),
            breaks=breaks, initial=self.initial if from_the_start else (math.nan, math.nan), settled=self.settled and from_the_start,
        )  # fmt: skip


def lengths(
    recording: Recording, rig: Rig, model: mujoco.MjModel, links: tuple[Linkage, ...]
) -> dict[str, tuple[Array, Array, float]]:
    """Return X and dX/dt of every cylinder whose joint was recorded, shape (n,) each, by MuJoCo's kinematics.

    The third value is the standard deviation of the white noise that X had before it was smoothed [m].
    """
    found: dict[str, tuple[Array, Array, float]] = {}
    data = mujoco.MjData(model)
    for link in links:
        joint = int(model.dof_jntid[link.dof])
        raw = recording.get(f"{model.joint(joint).name}.position")
        if raw is None or np.isfinite(raw).sum() < FEWEST_OF_CHANNEL:
            continue
        position, velocity = _smoothed(recording, raw)
        noise, retracted = white_noise(raw), rig.cylinders[link.cylinder].retracted_length
        if model.actuator_trntype[link.actuator] == int(mujoco.mjtTrn.mjTRN_JOINT):
            gear = float(model.actuator_gear[link.actuator, 0])
            found[link.cylinder] = gear * position - retracted, gear * velocity, abs(gear) * noise
            continue
        # a tendon across one joint: its length is a smooth function of that angle, tabulated finely
        low, high = float(np.nanmin(position)), float(np.nanmax(position))
        angles = np.linspace(low - 1e-6, high + 1e-6, 401)
        table, arms = np.empty(401), np.empty(401)
        for k, angle in enumerate(angles):
            data.qpos[:] = model.qpos0
            data.qpos[model.jnt_qposadr[joint]] = angle
            mujoco.mj_forward(model, data)
            table[k] = data.actuator_length[link.actuator]
            arms[k] = moment_row(model, data, link.actuator)[link.dof]
        length = np.interp(position, angles, table) - retracted
        arm = np.interp(position, angles, arms)
        found[link.cylinder] = length, arm * velocity, float(np.median(np.abs(arm))) * noise
    return found


def _smoothed(recording: Recording, values: Array) -> tuple[Array, Array]:
    """Return smoothed values and their rate, shape (n,) each; apart before and after every moment at which the clock was mended."""
    time = recording.time
    edges = [0, *(cut for cut in mended_at(time, recording.breaks) if FEWEST_OF_CHANNEL < cut < len(time) - FEWEST_OF_CHANNEL), len(time)]
    pieces = [smoothed(time[begin:end], values[begin:end]) for begin, end in itertools.pairwise(edges)]
    return np.concatenate([piece[0] for piece in pieces]), np.concatenate([piece[1] for piece in pieces])


def cylinder_runs(
    recording: Recording, rig: Rig, model: mujoco.MjModel, links: tuple[Linkage, ...]
) -> list[CylinderRun]:
    """Return one run for every cylinder of the rig of which the recording holds a pressure."""
    known = lengths(recording, rig, model, links)
    runs, computed = [], was_computed(recording)
    for name in rig.cylinders:
        p_1, p_2 = recording.get(f"{name}.pressure_1"), recording.get(f"{name}.pressure_2")
        if p_1 is None and p_2 is None:
            continue
        commands = [recording.get(f"{name}.{signal}") for signal in rig.cylinders[name].commands]
        commanded = all(f"{name}.{signal}" in recording for signal in rig.cylinders[name].needed_commands)
        length, speed, position_noise = known.get(name, (None, None, 0.0))
        placed = _position(recording, name, links)
        p_1, p_2 = (_where_placed(recording, placed, one) for one in (p_1, p_2))
        held = [np.zeros_like(recording.time) if one is None else _within_one(forward_filled(one)) for one in commands]
        runs.append(
            CylinderRun(
                recording=recording.name, cylinder=name, time=recording.time, command=held[0], length=length, speed=speed,
                pressure=(p_1, p_2), supply=_bridged(recording, "supply.pressure"), exhaust=_bridged(recording, "exhaust.pressure"),
                supply_temperature=_bridged(recording, "supply.temperature"), force=recording.get(f"{name}.force"),
                commanded=commanded, noise=(white_noise(p_1), white_noise(p_2)),
                breaks=stretch_starts(recording.time, p_1, p_2, placed, mended=recording.breaks), position_noise=position_noise,
                command_2=held[1] if len(held) > 1 else None, computed=computed,
            )  # fmt: skip
        )
    return runs


def _within_one(command: Array) -> Array:
    """Return a command cut to -1 to 1, shape (n,): the array itself where it leaves that nowhere."""
    return command if command.min() >= -1.0 and command.max() <= 1.0 else np.clip(command, -1.0, 1.0)


def _position(recording: Recording, cylinder: str, links: tuple[Linkage, ...]) -> Array | None:
    joint = next((link.joint for link in links if link.cylinder == cylinder), "")
    return recording.get(f"{joint}.position")


def _where_placed(recording: Recording, position: Array | None, pressure: Array | None) -> Array | None:
    """Return a pressure without what was recorded in a hole of the piston's position: how large its chamber was nobody knows."""
    if position is None or pressure is None or not (gaps := holes(recording.time, position)):
        return pressure
    known = pressure.copy()
    for begin, end in gaps:
        known[begin:end] = np.nan
    return known


def _bridged(recording: Recording, key: str) -> Array | None:
    """Return a slow channel with missing samples interpolated and its noise smoothed, or None."""
    values = recording.get(key)
    if values is None or np.isfinite(values).sum() < FEWEST_OF_CHANNEL:
        return None
    return smoothed(recording.time, values, 0.02)[0]
