"""A machine that nobody wears follows a motion: any MJCF with cylinders, its gas, and a controller."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim import progress
from exo_sim.control import user_controller
from exo_sim.control.tracking import Tracking, TrackingGains
from exo_sim.control.valve_control import CONTROLLERS, largest_forces
from exo_sim.errors import ModelError, ScenarioError, nearest
from exo_sim.machine.rig_model import load
from exo_sim.physics.conservation import Books
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig
from exo_sim.simulation.divergence import check_numbers, check_strokes
from exo_sim.simulation.force_loops import ForceLoops
from exo_sim.simulation.mujoco_calls import warnings_counted
from exo_sim.simulation.plugin import PneumaticPlugin
from exo_sim.simulation.unworn_log import UnwornLog
from exo_sim.simulation.wanted_motion import WantedMotion, check_reach, wanted

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MotionRun:
    """What was simulated.

    Attributes:
        rig, model: The machine.
        motion: What it was to do.
        controller: What moved the valves, by name.
        time: [s], shape (n,).
        columns: `"<part>.<signal>"` to values in SI, shape (n,).
        units: The same keys to SI units.
        qpos: Positions of MuJoCo at each row, shape (n, nq).
        books: Of the gas.
        interrupted: Whether it was stopped early.
    """

    rig: Rig
    model: mujoco.MjModel
    motion: WantedMotion
    controller: str
    time: Array
    columns: dict[str, Array]
    units: dict[str, str]
    qpos: Array
    books: Books
    interrupted: bool = False


class UnwornSimulation:
    """A machine that nobody wears, and the motion that it is to follow.

    Args:
        rig: The machine; its MJCF has cylinders on joints or tendons, and needs no person.
        recording: `<joint>.position` of every joint that a cylinder drives; `<joint>.external_force` where something acts on it.
        controller: "model" or "pi" (how valves get the forces of computed torque), or somebody's own.
        source: What to call it in messages and in the recording.
        seed: What somebody's own controller is given.

    Attributes:
        remarks: Plain sentences on what happened.

    Raises:
        ModelError, RigError: the machine cannot be built, or has no cylinder.
        RecordingError: the motion is none for this machine.
        ScenarioError: no such controller.
    """

    def __init__(
        self, rig: Rig, recording: Recording, controller: str | user_controller.Controller = "model", source: str = "", seed: int = 0
    ) -> None:
        if not rig.cylinders:
            raise ModelError(f"{rig.path}: no [cylinders.NAME]: nothing moves the machine")
        if isinstance(controller, str) and controller not in CONTROLLERS:
            raise ScenarioError(f'controller "{controller}"{nearest(controller, CONTROLLERS)}')
        rig.check_no_recovery("a machine that nobody wears")
        without = [c.name for c in rig.cylinders.values() if c.valve_area <= 0.0]
        if without:
            where = f"cylinders.{without[0]}"
            raise ModelError(f"{rig.path}: {where} has no valve, so that no controller can move it; write [{where}.valve]")
        self.rig, self.model = rig, load(rig)
        self.data = mujoco.MjData(self.model)
        self.plugin = PneumaticPlugin(self.model, rig)
        self.dt = float(self.model.opt.timestep)
        self.motion = wanted(recording, rig, self.model, self.plugin.links)
        check_reach(rig, self.model, self.motion, self.plugin.links)
        self.remarks: tuple[str, ...] = ()
        self.controller_name = source or (controller if isinstance(controller, str) else type(controller).__name__)
        dofs = np.array(sorted({link.dof for link in self.plugin.links}), dtype=np.int64)
        names = [self.model.joint(int(self.model.dof_jntid[dof])).name for dof in dofs]
        self._dofs, self._at = dofs, np.array([self.motion.joints.index(name) for name in names])
        cylinders = self.plugin.pneumatics.cylinders
        atmosphere = rig.environment.pressure
        self._limits = largest_forces(cylinders["area_1"], cylinders["area_2"], rig.supply.pressure, atmosphere, atmosphere)
        single = np.array([cylinder.single_acting for cylinder in rig.cylinders.values()])
        if single.any():  # chamber 2 is open: it can only push
            self._limits[single, 0], self._limits[single, 1] = 0.0, (rig.supply.pressure - atmosphere) * cylinders["area_1"][single]
        actuators = np.array([link.actuator for link in self.plugin.links], dtype=np.int64)
        self._tracking = Tracking(self.model, dofs, actuators, self._limits, TrackingGains())
        self._external = [(int(self.model.joint(name).dofadr[0]), values) for name, values in self.motion.external.items()]
        self._log = UnwornLog(self.plugin, self.motion)
        self._force_loops = ForceLoops(self.plugin, controller if isinstance(controller, str) else "model", self.dt)
        self._asked: user_controller.RunningController | None = None
        if not isinstance(controller, str):
            every = user_controller.period_of(controller, self.dt, self.controller_name)
            context = user_controller.Context(
                rig, tuple(rig.cylinders), tuple(names), tuple(self._log.units), every * self.dt, self.dt,
                float(self.motion.time[-1]), scenario=self.motion.name, seed=seed, reference=self.motion.at,
            )  # fmt: skip
            self._asked = user_controller.RunningController(controller, context, self.controller_name)
        self.reset()

    def reset(self) -> None:
        """Put the machine at the start of its motion, moving with it, gas at rest at the atmosphere."""
        model, data, motion = self.model, self.data, self.motion
        mujoco.mj_resetData(model, data)
        for j, name in enumerate(motion.joints):
            joint = model.joint(name)
            data.qpos[joint.qposadr[0]], data.qvel[joint.dofadr[0]] = motion.position[0, j], motion.velocity[0, j]
        self.plugin.reset(data)
        self._tracking.reset()
        self._force_loops.reset()
        self._felt = np.zeros(len(self._external))
        self._given: user_controller.Commands | None = None
        self._step = 0

    @property
    def rows(self) -> int:
        """How many rows a whole run has."""
        return len(self.motion.time)

    def run(self, quiet: bool = True, stop: Callable[[], bool] = lambda: False) -> MotionRun:
        """Simulate the whole motion.

        Raises:
            Diverged: numbers that mean nothing any more, or a warning of MuJoCo.
            ScenarioError: somebody's own controller fails.
        """
        self.reset()
        if self._asked is not None:
            self._asked.reset()
        log = np.empty((self.rows, len(self._log.units)))
        qpos = np.empty((self.rows, self.model.nq))
        done = 0
        every = max(1, round(self._asked.context.period / self.dt)) if self._asked is not None else 1
        with progress.Bar(self.rows * self.dt, self.motion.name, unit="s", quiet=quiet) as bar, warnings_counted():
            for k in range(self.rows):
                if self._asked is not None and k > 0 and (k - 1) % every == 0:
                    try:
                        self._given = self._asked.act(self.observation(log[k - 1]))
                    except KeyboardInterrupt:
                        if not stop():
                            raise
                        break
                self.advance(log[k], qpos[k])
                done = k + 1
                if done % 200 == 0:
                    self._check(log[done - 200 : done])
                    bar.to(done * self.dt)
                    if stop():
                        break
        self._check(log[:done])
        if self._asked is not None:
            self.remarks = self._asked.remarks()
        columns = {key: np.ascontiguousarray(log[:done, i]) for i, key in enumerate(self._log.units)}
        return MotionRun(
            self.rig, self.model, self.motion, self.controller_name, self.motion.time[:done], columns,
            dict(self._log.units), qpos[:done], self.plugin.books(), done < self.rows,
        )  # fmt: skip

    def observation(self, row: Array) -> dict[str, float]:
        """Return a row of the log by names, with "time" [s]."""
        return {"time": (self._step - 1) * self.dt, **dict(zip(self._log.units, row.tolist()))}

    def command(self, commands: user_controller.Commands | None) -> None:
        """Let commands from outside count from the next step on; None gives the machine back to the built-in controller."""
        self._given = commands

    def advance(self, row: Array, qpos: Array) -> None:
        """Take one step; what it began with goes into `row` and `qpos`."""
        model, data, plugin, k = self.model, self.data, self.plugin, self._step
        mujoco.mj_step1(model, data)
        plugin.advance(data)
        for i, (dof, values) in enumerate(self._external):
            now = values[min(k, len(values) - 1)]
            data.qfrc_applied[dof] += now - self._felt[i]
            self._felt[i] = now
        rods = self._wanted_rods(min(k, self.rows - 1))
        if self._given is not None and self._given.kind == user_controller.VALVES:
            plugin.plant.command[:] = np.clip(self._given.values, -1.0, 1.0)
        elif self._given is None and self._asked is not None:
            plugin.plant.command[:] = 0.0
        else:
            self._force_loops.open_valves(data, rods, first=k == 0)
        qpos[:] = data.qpos
        before = data.qvel.copy()
        plugin.compute(data)
        self._log.write(row, min(k, self.rows - 1), data, self._tracking.made(data, plugin.force), self._felt, rods, before)
        mujoco.mj_step2(model, data)
        self._step += 1

    def _wanted_rods(self, k: int) -> Array:
        data, motion = self.data, self.motion
        if self._given is not None:
            if self._given.kind == user_controller.VALVES:
                return np.full(len(self._limits), math.nan)
            force = self._given.values
        else:
            at = self._at
            force = self._tracking.joint_force(data, motion.position[k, at], motion.velocity[k, at], motion.acceleration[k, at], self.dt)
        return self._tracking.rod_forces(data, force)

    def _check(self, rows: Array) -> None:
        when = f"by {self._step * self.dt:.3f} s"
        advice = "try a shorter timestep in the MJCF, or a slower motion"
        keys, strokes = list(self._log.units), {cylinder.name: cylinder.stroke for cylinder in self.rig.cylinders.values()}
        check_numbers(self.data, rows, keys, self.motion.name, when, advice)
        advice += "; are its masses and the range of its joint right?"
        check_strokes(rows, keys, strokes, self.motion.name, when, advice)
