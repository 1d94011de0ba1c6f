"""The walking machine and the bench, stepped in every way that is compared: bare, from Python and in a compiled loop."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from pathlib import Path

import mujoco
import mujoco.rollout
import numba
import numpy as np

from exo_sim.physics.compiled import borrow
from exo_sim.rig import Rig
from exo_sim.simulation.coupled_step import advance_gas, compute_forces
from exo_sim.simulation.mujoco_calls import call
from exo_sim.simulation.plugin import PneumaticPlugin
from exo_sim.simulation.views import mechanics

ROOT = Path(__file__).resolve().parents[2]
STEPS, REPEATS = 4000, 9


@numba.njit(nogil=True)
def compiled_loop(commands, mechanics, plant):
    """Take one coupled step a row of `commands`."""
    mechanics, plant = borrow(mechanics), borrow(plant)
    for i in range(len(commands)):
        call(mechanics.step1, mechanics.model, mechanics.data)
        if i > 0:
            advance_gas(mechanics, plant)
        for j in range(plant.command.size):
            plant.command[j] = commands[i, j]
        compute_forces(mechanics, plant)
        call(mechanics.step2, mechanics.model, mechanics.data)


class Machine:
    """A machine held up by springs, its valves swinging; `record` takes the path that all ways of stepping take again."""

    def __init__(self, rig: Rig, start: float | None = None) -> None:
        spec = mujoco.MjSpec.from_file(str(rig.model))
        for joint in spec.joints:
            torso = joint.name.startswith("torso")
            joint.stiffness[0], joint.damping[0] = (2e4, 500.0) if torso else (1000.0, 20.0)
            if start is not None:
                joint.springref = start
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.plugin = PneumaticPlugin(self.model, rig)
        self.place = start
        time_ = np.arange(STEPS) * self.plugin.dt
        phases = np.arange(len(self.plugin.command))
        self.commands = np.ascontiguousarray(0.15 * np.sin(2 * np.pi * time_[:, None] + phases))
        self.ctrl = np.zeros((STEPS, self.model.nu))
        self.contacts = 0

    def start(self) -> None:
        mujoco.mj_resetData(self.model, self.data)
        if self.place is not None:
            self.data.qpos[:] = self.place
        self.plugin.reset(self.data)

    def record(self) -> None:
        """Take the path once, keeping the forces."""
        self.start()
        kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
        self.state = np.zeros((1, mujoco.mj_stateSize(self.model, kind)))
        mujoco.mj_getState(self.model, self.data, self.state[0], kind)
        for i, command in enumerate(self.commands):
            self.plugin.step(self.data)
            self.plugin.command[:] = command
            self.ctrl[i] = self.data.ctrl
            self.contacts += self.data.ncon
        self.end = self.data.qpos.copy()
        assert np.isfinite(self.end).all() and not self.data.warning.number.any(), "the machine came apart"

    def bare(self) -> float:
        """Return seconds of bare C steps along the path."""
        data = mujoco.MjData(self.model)
        with mujoco.rollout.Rollout(nthread=0) as rollout:
            begun = time.perf_counter()
            states, _ = rollout.rollout(self.model, data, self.state, self.ctrl[None])
            taken = time.perf_counter() - begun
        assert np.array_equal(states[0, -1, 1 : 1 + self.model.nq], self.end), "the bare path is another one"
        return taken

    def from_python(self) -> float:
        """Return seconds of coupled steps, the loop in Python."""
        self.start()
        data, command, step = self.data, self.plugin.command, self.plugin.step
        begun = time.perf_counter()
        for row in self.commands:
            step(data)
            command[:] = row
        taken = time.perf_counter() - begun
        assert np.array_equal(data.qpos, self.end), "the path from Python is another one"
        return taken

    def compiled(self) -> float:
        """Return seconds of coupled steps, the loop compiled."""
        self.start()
        data, seen = self.data, mechanics(self.model, self.data)
        begun = time.perf_counter()
        compiled_loop(self.commands, seen, self.plugin.plant)
        taken = time.perf_counter() - begun
        assert np.array_equal(data.qpos, self.end), "the compiled path is another one"
        return taken


def quickest(kinds: Mapping[str, Callable[[], float]], repeats: int = REPEATS) -> dict[str, float]:
    """Return the least seconds of each; they take turns, so that a disturbance meets them all."""
    for measure in kinds.values():
        measure()
    taken = {name: float("inf") for name in kinds}
    for _ in range(repeats):
        for name, measure in kinds.items():
            taken[name] = min(taken[name], measure())
    return taken
