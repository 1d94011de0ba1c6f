"""One recording in one machine: the inputs of the compiled loop, its runs, and their results on the recording's clock."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.conventions.fed_chambers import fed_cylinders
from exo_sim.errors import RecordingError
from exo_sim.machine.linkage import moment_row
from exo_sim.physics import state
from exo_sim.physics.plant_records import switch_off
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig
from exo_sim.simulation.plugin import PneumaticPlugin
from exo_sim.simulation.replay import inputs
from exo_sim.simulation.replay.external_drive import externally_driven
from exo_sim.simulation.replay.loop import Feed, run
from exo_sim.simulation.views import Mechanics, Plant, mechanics

Array = NDArray[np.float64]

#: Steps between two reports of progress.
CHUNK = 20000
#: More steps than this are refused: ten hours in steps of a millisecond.
MOST_STEPS = 36_000_000


class RecordedMachine:
    """The machine of one recording, ready to be run under its inputs with windows of any length.

    Args:
        recording: Signals in SI, sensor effects that the rig knows taken off.
        rig, model: The machine; MuJoCo's automatic reset is switched off in the model.
        early: By column of valve commands, how long before each sample it is held [s]; nil where absent.

    Raises:
        RecordingError: the clock is too long, or jumps everywhere.
    """

    def __init__(self, recording: Recording, rig: Rig, model: mujoco.MjModel, early: Mapping[str, float] | None = None):
        rig.check_no_recovery("a recording")
        self.recording, self.rig, self.model, self._early = recording, rig, model, early or {}
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
        self.plugin = PneumaticPlugin(model, rig)
        self.dt = float(model.opt.timestep)
        self.joints = inputs.recorded_joints(recording, model)
        self.names = [model.joint(j).name for j in self.joints]
        if recording.duration > MOST_STEPS * self.dt:
            raise RecordingError(
                f'"{recording.name}": {recording.duration:.3g} s in steps of {self.dt:g} s are too many to simulate; '
                "is its clock in seconds? Else cut it into pieces"
            )
        self.led = fed_cylinders(recording, rig, model)
        self.pieces = inputs.steps(recording.time, self.dt, recording.breaks)
        if not self.pieces:
            raise RecordingError(f'"{recording.name}": its clock jumps at every few samples; nothing can be simulated')
        n = sum(len(piece.time) for piece in self.pieces)
        # mj_step2 lets velocities leap before positions: a velocity is that of half a step ago, and then its error is of second order
        moves = [
            inputs.motion(self.pieces, recording.time, recording[f"{name}.position"], 0.5 * self.dt) for name in self.names
        ]
        empty = np.zeros((0, n))
        self.position = np.ascontiguousarray(np.array([there for there, _ in moves] or empty).T)
        self.velocity = np.ascontiguousarray(np.array([rate for _, rate in moves] or empty).T)

    def imposed(self, motion: str) -> dict[str, str]:
        """Return the joints whose motion must be imposed as recorded, and why; `motion` as in `replay`."""
        if motion == "recorded" or (motion == "predicted" and len(self.joints) == self.model.njnt):
            return dict.fromkeys(self.names, "as asked") if motion == "recorded" else {}
        return externally_driven(self.recording, self.rig, self.model, self.plugin.links)

    def predictable(self, imposed: bool) -> list[str]:
        """Return the columns that can be predicted."""
        found = []
        for link in self.plugin.links:
            if link.cylinder not in self.led and self._length_known(link.actuator):
                found += [f"{link.cylinder}.pressure_1", f"{link.cylinder}.pressure_2"]
        if not imposed and len(self.joints) == self.model.njnt:
            found += [f"{name}.position" for name in self.names]
        return found

    def imposed_pressures(self) -> list[str]:
        """Return of which cylinders the pressures are imposed as recorded, in plain sentences."""
        return [f"pressures of {name} are led as recorded: gas is let in that no recorded command speaks of" for name in sorted(self.led)]

    def assumed(self) -> list[str]:
        """Return what had to be assumed, in plain sentences."""
        return [
            f"no valve command of {c.name} was recorded: its valve is taken as closed"
            if len(c.commands) == 1
            else f"{c.name}.{command} was not recorded: that side of its valve is taken as closed"
            for c in self.rig.cylinders.values()
            for command in c.commands
            if c.valve_area > 0.0 and f"{c.name}.{command}" not in self.recording and c.name not in self.led
        ]

    def _length_known(self, actuator: int) -> bool:
        """Return whether all joints that a cylinder spans were recorded."""
        data = mujoco.MjData(self.model)
        for j, place in zip(self.joints, self.position[0], strict=True):
            data.qpos[self.model.jnt_qposadr[j]] = place + 0.01
        mujoco.mj_forward(self.model, data)
        spanned = np.flatnonzero(np.abs(moment_row(self.model, data, actuator)) > 1e-9)
        return all(int(self.model.dof_jntid[dof]) in self.joints for dof in spanned)

    def run(self, window: float, imposed: bool, progress: Callable[[float], None]) -> dict[str, Array]:
        """Return predicted pressures and positions on the recording's clock."""
        feed, data = self._feed(window, imposed), mujoco.MjData(self.model)
        seen, plant = self._machine(data, feed)
        total = len(feed.supply)
        pressures = np.empty((total, len(self.plugin.links), 2))
        positions = np.empty((total, len(self.joints)))
        filled = plant.vector.copy()
        begun = 0
        for first in range(0, total, CHUNK):
            stop = min(total, first + CHUNK)
            begun = run(first, stop, begun, seen, plant, feed, filled, pressures, positions)
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

    def _feed(self, window: float, imposed: bool) -> Feed:
        recording, rig, pieces, time = self.recording, self.rig, self.pieces, self.recording.time
        n = sum(len(piece.time) for piece in pieces)
        measured = [recording.get(f"{name}.pressure_{side}") for name in rig.cylinders for side in (1, 2)]
        starts = inputs.window_starts(pieces, window, time, measured)
        cylinders, half = list(rig.cylinders), 0.5 * self.dt
        command = np.zeros((n, self.plugin.pneumatics.commands))
        pressure = np.full((len(starts), len(cylinders), 2), math.nan)
        for i, name in enumerate(cylinders):
            for side, signal in enumerate(rig.cylinders[name].commands):
                key = f"{name}.{signal}"
                if key in recording:
                    told = inputs.held(pieces, time, recording[key], self._early.get(key, 0.0))
                    command[:, i + side * len(cylinders)] = np.clip(told, -1.0, 1.0)
            for side in (1, 2):
                pressure[:, i, side - 1] = inputs.start_pressures(pieces, starts, time, measured[2 * i + side - 1])
        external = [inputs.between(pieces, time, recording.get(f"{name}.external_force"), 0.0) for name in self.names]
        model = self.model
        position, velocity = (self.position, self.velocity) if imposed else self._begun(starts)
        return Feed(
            command,
            np.ascontiguousarray(np.array(external or np.zeros((0, n))).T),
            inputs.between(pieces, time, recording.get("supply.pressure"), rig.supply.pressure, half),
            inputs.between(pieces, time, recording.get("supply.temperature"), rig.supply.temperature, half),
            inputs.between(pieces, time, recording.get("exhaust.pressure"), rig.environment.pressure, half),
            position,
            velocity,
            np.array([model.jnt_qposadr[j] for j in self.joints], dtype=np.int64),
            np.array([model.jnt_dofadr[j] for j in self.joints], dtype=np.int64),
            imposed,
            starts,
            pressure,
            self._imposed(measured),
        )

    def _imposed(self, measured: Sequence[Array | None]) -> Array:
        """Return the pressures that are imposed at every step, shape (n, cylinders, 2), or (0, 0, 0) where all are predicted."""
        if not self.led:
            return np.zeros((0, 0, 0))
        n = sum(len(piece.time) for piece in self.pieces)
        found = np.full((n, len(self.rig.cylinders), 2), math.nan)
        for i, name in enumerate(self.rig.cylinders):
            if name in self.led:
                for side in range(2):
                    found[:, i, side] = inputs.between(self.pieces, self.recording.time, measured[2 * i + side], math.nan)
        return found

    def _begun(self, starts: NDArray[np.int64]) -> tuple[Array, Array]:
        """Return measured motion, in which windows begin with what a noisy position says best."""
        position, velocity = self.position.copy(), self.velocity.copy()
        for j, name in enumerate(self.names):
            found = inputs.start_motion(self.pieces, starts, self.recording.time, self.recording[f"{name}.position"], 0.5 * self.dt)
            if found is not None:
                position[starts, j], velocity[starts, j] = found
        return position, velocity

    def _machine(self, data: mujoco.MjData, feed: Feed) -> tuple[Mechanics, Plant]:
        """Fill the machine with gas at its first measured state and return all that the loop works on."""
        model, plugin, gas = self.model, self.plugin, self.plugin.pneumatics
        data.qpos[feed.qpos_at] = feed.position[0]
        data.qvel[feed.dof_at] = feed.velocity[0]
        gas.world["supply_pressure"], gas.world["supply_temperature"] = feed.supply[0], feed.supply_temperature[0]
        gas.world["exhaust_pressure"] = feed.exhaust[0]
        switch_off(gas.world, [place for place in ("supply", "exhaust") if f"{place}.pressure" in self.recording])
        first = np.where(np.isfinite(feed.pressure[0]), feed.pressure[0], self.rig.environment.pressure)
        plugin.reset(data, first[:, 0].copy(), first[:, 1].copy())
        plugin.plant.command[:] = feed.command[0]
        one, two = feed.command[0][: len(plugin.links)], feed.command[0][len(plugin.links) :]
        gas.memory[:, state.SPOOL] = one
        if two.size:
            gas.memory[:, state.SPOOL_2] = two
        gas.history[:, :-1] = feed.command[0][:, None]
        return mechanics(model, data), plugin.plant
