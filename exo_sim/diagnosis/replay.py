"""A recording, simulated: the rig's whole machine under the recorded commands, supply and outside forces."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis import replay_inputs as fed
from exo_sim.diagnosis.library import switch_off
from exo_sim.diagnosis.replay_loop import Feed, Machine, run
from exo_sim.errors import RecordingError, nearest
from exo_sim.machine.linkage import moment_row
from exo_sim.machine.load import load
from exo_sim.physics import state
from exo_sim.recording import health
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig
from exo_sim.signals import SHARED_PARTS
from exo_sim.simulation.native import address
from exo_sim.simulation.plugin import PneumaticPlugin
from exo_sim.simulation.sensors import observe, seen_through

Array = NDArray[np.float64]

#: Length of a window [s].
WINDOW = 0.5
_CHUNK = 20000
#: More steps than this are refused: ten hours in steps of a millisecond.
MOST_STEPS = 36_000_000


@dataclass(frozen=True)
class Replay:
    """What a rig predicts of a recording, on the recording's clock, as its sensors would show it.

    Attributes:
        windowed: Predicted columns, the measured state taken over every `WINDOW` seconds; NaN where the simulation was lost.
        free_run: The same from the first measured state on. Of positions only where motion is predicted.
        led: Joints whose motion was imposed as recorded, and why; then all of them are.
        remarks: Plain sentences about what was assumed.
    """

    windowed: Recording
    free_run: Recording
    led: Mapping[str, str]
    remarks: tuple[str, ...]

    @property
    def measure(self) -> str:
        """What the errors are, in words."""
        how = "motion led as recorded" if self.led else "motion predicted too"
        return f"rms of {WINDOW:g} s predictions, and of one run from the first measured state; {how}"


def check_belongs(recording: Recording, rig: Rig, model: mujoco.MjModel) -> tuple[str, ...]:
    """Return remarks on parts that the rig does not have.

    Raises:
        RecordingError: the recording is of another machine, or never mentions a cylinder of the rig.
    """
    joints = [model.joint(j).name for j in range(model.njnt)]
    sites = [model.site(i).name for i in range(model.nsite)]
    parts = recording.parts()
    own = [part for part in parts if part in rig.cylinders or part in joints]
    there = [part for part in parts if part not in SHARED_PARTS]
    if not own:
        known = [*rig.cylinders, *(name for name in joints if name not in rig.cylinders)]
        listed = ", ".join(there[:4]) or "no part of a machine"
        raise RecordingError(
            f'"{recording.name}": it holds {listed}, but the rig {rig.path} has {", ".join(known)}; '
            "give the rig of this machine, or a column map"
        )
    for name in rig.cylinders:
        if not any(f"{name}.{signal}" in recording for signal in ("valve_command", "pressure_1", "pressure_2")):
            strange = [part for part in there if part not in rig.cylinders]
            raise RecordingError(
                f'"{recording.name}": no valve command and no pressure of cylinder "{name}" of {rig.path}{nearest(name, strange)}'
            )
    strange = [part for part in there if part not in own and part not in sites]
    return tuple(f'"{part}" is no part of the rig; its columns were not used' for part in strange)


def usable(recording: Recording, rig: Rig, model: mujoco.MjModel) -> tuple[Recording, list[health.Finding]]:
    """Return a recording without what its sensors cannot have seen, as this rig knows them, and what was noticed."""
    odd = list(health.check(seen_through(recording, rig)[0], health.Facts.of(rig, model)))
    return health.without_faults(recording, odd), odd


def replay(
    recording: Recording, rig: Rig, model: mujoco.MjModel | None = None, *, motion: str = "auto", window: float = WINDOW,
    progress: Callable[[float], None] | None = None,
) -> Replay:  # fmt: skip
    """Simulate what was recorded.

    Measured pressures and positions are predicted: over windows, each from the measured state at its start (gas temperatures, spools
    and dry contacts are carried on from window to window, for nothing measures them), and in one run from the first state. Where
    joints were led from outside by forces that nobody measured, or not all of them were recorded, motion is imposed as recorded and
    only pressures are predicted.

    Args:
        recording: Signals in SI.
        rig: The machine.
        model: Its model, where it is loaded already.
        motion: "predicted", "recorded", or "auto": predicted unless `replay_inputs.led_from_outside` says otherwise.
        window: Length of a window [s].
        progress: Called with the share done, 0 to 1.

    Raises:
        RecordingError: the recording is of another machine, or holds nothing that can be predicted.
        ModelError: the model lacks a part of the rig.
    """
    model = load(rig) if model is None else model
    remarks = list(check_belongs(recording, rig, model))
    simulation, led, wanted = _ready(recording, rig, model, motion)
    remarks += [f"motion of {name} is led as recorded: {why}" for name, why in led.items()]
    remarks += simulation.assumed()
    told = progress or (lambda share: None)
    windowed = simulation.run(window, bool(led), lambda share: told(0.5 * share))
    free = simulation.run(math.inf, bool(led), lambda share: told(0.5 + 0.5 * share))
    shown = [_shown(recording, rig, {key: values[key] for key in wanted}) for values in (windowed, free)]
    return Replay(shown[0], shown[1], led, tuple(remarks))


@dataclass(frozen=True)
class FreeRun:
    """One run from the first measured state.

    Attributes:
        predicted: As `Replay.free_run`.
        simulated: Which samples it holds; not those of stretches between two jumps of the clock that are too short, shape (n,).
        led: Whether motion was imposed as recorded.
    """

    predicted: Recording
    simulated: NDArray[np.bool_]
    led: bool


def free_run(recording: Recording, rig: Rig, model: mujoco.MjModel, *, motion: str = "auto") -> FreeRun | None:
    """Simulate what was recorded in one run; None where something that it hangs on was not recorded and would have to be assumed.

    Args:
        recording, rig, model, motion: As for `replay`.

    Raises:
        RecordingError, ModelError: as `replay`.
    """
    simulation, led, wanted = _ready(recording, rig, model, motion)
    begun = [f"{c.name}.pressure_{side}" for c in rig.cylinders.values() for side in ((1,) if c.single_acting else (1, 2))]
    if simulation.assumed() or any(key not in recording for key in begun):
        return None
    values = simulation.run(math.inf, bool(led), lambda share: None)
    simulated = np.zeros(len(recording.time), dtype=bool)
    for piece in simulation.pieces:
        simulated[piece.first : piece.last] = True
    return FreeRun(_shown(recording, rig, {key: values[key] for key in wanted}), simulated, bool(led))


def _ready(
    recording: Recording, rig: Rig, model: mujoco.MjModel, motion: str
) -> tuple[_Simulation, dict[str, str], list[str]]:
    """Return the simulation, the joints that are led and why, and the columns to be predicted."""
    simulation = _Simulation(seen_through(recording, rig)[0], rig, model)
    led = simulation.led(motion)
    keys = simulation.predictable(bool(led))
    wanted = [key for key in keys if np.isfinite(recording.columns.get(key, np.zeros(0))).any()]
    if not wanted:
        raise RecordingError(
            f'"{recording.name}": nothing in it can be predicted; it needs the position of a joint, and a pressure, a valve command '
            "or an outside force"
        )
    return simulation, led, wanted


def rms(recorded: Array, predicted: Array) -> float:
    """Return the root of the mean square difference where something was recorded; NaN where the prediction was lost on the way."""
    there = np.isfinite(recorded)
    return float(np.sqrt(np.mean((predicted[there] - recorded[there]) ** 2))) if there.any() else math.nan


def _shown(recording: Recording, rig: Rig, columns: dict[str, Array]) -> Recording:
    """Return predicted columns as the rig's sensors show them."""
    units = {key: recording.units[key] for key in columns}
    sensing = tuple(e for e in rig.effects if e.where in columns or not e.name.startswith("sensor_"))
    return observe(Recording(recording.name, recording.time, columns, units), replace(rig, effects=sensing))


class _Simulation:
    """One recording in one machine, ready to be run with windows of any length."""

    def __init__(self, recording: Recording, rig: Rig, model: mujoco.MjModel):
        self.recording, self.rig, self.model = recording, rig, model
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
        self.plugin = PneumaticPlugin(model, rig)
        self.dt = float(model.opt.timestep)
        self.joints = fed.recorded_joints(recording, model)
        self.names = [model.joint(j).name for j in self.joints]
        if recording.duration > MOST_STEPS * self.dt:
            raise RecordingError(
                f'"{recording.name}": {recording.duration:.3g} s in steps of {self.dt:g} s are too many to simulate; '
                "is its clock in seconds? Else cut it into pieces"
            )
        self.pieces = fed.steps(recording.time, self.dt)
        if not self.pieces:
            raise RecordingError(f'"{recording.name}": its clock jumps at every few samples; nothing can be simulated')
        n = sum(len(piece.time) for piece in self.pieces)
        # mj_step2 lets velocities leap before positions: a velocity is that of half a step ago, and then its error is of second order
        moves = [
            fed.motion(self.pieces, recording.time, recording[f"{name}.position"], 0.5 * self.dt) for name in self.names
        ]
        empty = np.zeros((0, n))
        self.position = np.ascontiguousarray(np.array([there for there, _ in moves] or empty).T)
        self.velocity = np.ascontiguousarray(np.array([rate for _, rate in moves] or empty).T)

    def led(self, motion: str) -> dict[str, str]:
        if motion == "recorded" or (motion == "predicted" and len(self.joints) == self.model.njnt):
            return dict.fromkeys(self.names, "as asked") if motion == "recorded" else {}
        return fed.led_from_outside(self.recording, self.rig, self.model, self.plugin.links)

    def predictable(self, led: bool) -> list[str]:
        """Return the columns that can be predicted."""
        found = []
        for link in self.plugin.links:
            if self._length_known(link.actuator):
                found += [f"{link.cylinder}.pressure_1", f"{link.cylinder}.pressure_2"]
        if not led and len(self.joints) == self.model.njnt:
            found += [f"{name}.position" for name in self.names]
        return found

    def assumed(self) -> list[str]:
        """Return what had to be assumed, in plain sentences."""
        return [
            f"no valve command of {c.name} was recorded: its valve is taken as closed"
            for c in self.rig.cylinders.values()
            if c.valve_area > 0.0 and f"{c.name}.valve_command" not in self.recording
        ]

    def _length_known(self, actuator: int) -> bool:
        """Say whether all joints that a cylinder spans were recorded."""
        data = mujoco.MjData(self.model)
        for j, place in zip(self.joints, self.position[0], strict=True):
            data.qpos[self.model.jnt_qposadr[j]] = place + 0.01
        mujoco.mj_forward(self.model, data)
        spanned = np.flatnonzero(np.abs(moment_row(self.model, data, actuator)) > 1e-9)
        return all(int(self.model.dof_jntid[dof]) in self.joints for dof in spanned)

    def run(self, window: float, led: bool, progress: Callable[[float], None]) -> dict[str, Array]:
        """Return predicted pressures and positions on the recording's clock."""
        feed, data = self._feed(window, led), mujoco.MjData(self.model)
        machine = self._machine(data, feed)
        total = len(feed.supply)
        pressures = np.empty((total, len(self.plugin.links), 2))
        positions = np.empty((total, len(self.joints)))
        filled = machine.vector.copy()
        begun = 0
        for first in range(0, total, _CHUNK):
            stop = min(total, first + _CHUNK)
            begun = run(first, stop, begun, machine, feed, filled, pressures, positions)
            progress(stop / total)
        starts = set(feed.starts.tolist())
        found = {}
        for i, link in enumerate(self.plugin.links):
            for side in (1, 2):
                found[f"{link.cylinder}.pressure_{side}"] = self._on_clock(pressures[:, i, side - 1], starts)
        for j, name in enumerate(self.names):
            found[f"{name}.position"] = self._on_clock(positions[:, j], starts)
        return found

    def _on_clock(self, values: Array, starts: set[int]) -> Array:
        """Return values at the recording's samples, never between two windows; NaN where nothing was simulated."""
        time = self.recording.time
        out = np.full(len(time), math.nan)
        for piece in self.pieces:
            own = values[piece.offset : piece.offset + len(piece.time)]
            place = (time[piece.first : piece.last] - piece.time[0]) / self.dt
            left = np.minimum(np.floor(place + 1e-6).astype(np.int64), len(own) - 1)
            right = np.minimum(left + 1, len(own) - 1)
            begins = np.isin(right + piece.offset, list(starts))
            share = np.where(begins, 0.0, np.clip(place - left, 0.0, 1.0))
            share = np.where(share < 1e-6, 0.0, share)
            out[piece.first : piece.last] = np.where(
                share > 0.0, (1.0 - share) * own[left] + share * own[right], own[left]
            )
        return out

    def _feed(self, window: float, led: bool) -> Feed:
        recording, rig, pieces, time = self.recording, self.rig, self.pieces, self.recording.time
        n = sum(len(piece.time) for piece in pieces)
        measured = [recording.get(f"{name}.pressure_{side}") for name in rig.cylinders for side in (1, 2)]
        starts = fed.window_starts(pieces, window, time, measured)
        cylinders, half = list(rig.cylinders), 0.5 * self.dt
        command = np.zeros((n, len(cylinders)))
        pressure = np.full((len(starts), len(cylinders), 2), math.nan)
        for i, name in enumerate(cylinders):
            values = recording.get(f"{name}.valve_command")
            if values is not None:
                command[:, i] = np.clip(fed.held(pieces, time, values), -1.0, 1.0)
            for side in (1, 2):
                pressure[:, i, side - 1] = fed.start_pressures(pieces, starts, time, measured[2 * i + side - 1])
        external = [fed.between(pieces, time, recording.get(f"{name}.external_force"), 0.0) for name in self.names]
        model = self.model
        return Feed(
            command,
            np.ascontiguousarray(np.array(external or np.zeros((0, n))).T),
            fed.between(pieces, time, recording.get("supply.pressure"), rig.supply.pressure, half),
            fed.between(pieces, time, recording.get("supply.temperature"), rig.supply.temperature, half),
            fed.between(pieces, time, recording.get("exhaust.pressure"), rig.environment.pressure, half),
            self.position,
            self.velocity,
            np.array([model.jnt_qposadr[j] for j in self.joints], dtype=np.int64),
            np.array([model.jnt_dofadr[j] for j in self.joints], dtype=np.int64),
            led,
            starts,
            pressure,
        )

    def _machine(self, data: mujoco.MjData, feed: Feed) -> Machine:
        """Fill the machine with gas at its first measured state and gather all that the loop works on."""
        model, plugin, gas = self.model, self.plugin, self.plugin.pneumatics
        data.qpos[feed.qpos_at] = feed.position[0]
        data.qvel[feed.dof_at] = feed.velocity[0]
        gas.world["supply_pressure"], gas.world["supply_temperature"] = feed.supply[0], feed.supply_temperature[0]
        gas.world["exhaust_pressure"] = feed.exhaust[0]
        switch_off(gas.world, [place for place in ("supply", "exhaust") if f"{place}.pressure" in self.recording])
        first = np.where(np.isfinite(feed.pressure[0]), feed.pressure[0], self.rig.environment.pressure)
        plugin.reset(data, first[:, 0].copy(), first[:, 1].copy())
        plugin.command[:] = feed.command[0]
        gas.memory[:, state.SPOOL] = gas.memory[:, state.PLAY] = feed.command[0]
        gas.history[:, :-1] = feed.command[0][:, None]
        return Machine(
            address("mj_step1"), address("mj_step2"), model._address, data._address, self.dt,
            data.qpos, data.qvel, data.ctrl, data.qfrc_applied, data.actuator_length, data.actuator_velocity,
            data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind,
            gas.world, gas.cylinders, gas.joints, gas.vector, gas.history,
            plugin._actuators, np.array([link.dof for link in plugin.links], dtype=np.int64), plugin._retracted,
            plugin._dofs, plugin._addresses, plugin._x, plugin._x1, plugin._v, plugin._force,
            plugin._q, plugin._q1, plugin._qd, plugin._own, plugin._felt, plugin.command, gas._work, gas._scratch,
        )  # fmt: skip
