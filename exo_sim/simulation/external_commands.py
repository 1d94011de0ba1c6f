"""A worn machine under commands from outside: a controller that somebody brought, or one step at a time.

What a controller observes was measured one step of the simulation before its commands take effect. The first step is taken with closed
valves, or without torque, because there is nothing to observe before it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.control import user_controller
from exo_sim.control.valve_control import GIVEN, controller_code
from exo_sim.errors import Diverged
from exo_sim.gait.motion import reference
from exo_sim.simulation import loop
from exo_sim.simulation.loop_wiring import wire
from exo_sim.simulation.mujoco_calls import warnings_counted
from exo_sim.simulation.valve_loop import Drives
from exo_sim.simulation.walk import JOINTS, Walk, layout
from exo_sim.simulation.worn_log import keys_of, walk_of

if TYPE_CHECKING:
    from exo_sim.simulation.worn import Simulation

Array = NDArray[np.float64]
#: Advances a run: first step, number of steps, rows of the log; returns what became of the gas.
Advance = Callable[[int, int, Array], int]


def context(simulation: Simulation, controller: Any, seed: int = 0) -> user_controller.Context:
    """Return what a controller of a worn machine gets to know."""
    it = simulation
    source = it.request.controller
    every = user_controller.period_of(controller, it.dt, source)
    duration = it.cycles * it.motion.period
    return user_controller.Context(
        rig=it.rig, cylinders=tuple(it.rig.cylinders), joints=JOINTS, signals=tuple(key for _, key in _observed(it)),
        period=every * it.dt, step=it.dt, duration=duration, cycle=it.motion.stride_time, scenario=it.request.scenario,
        payload=it.request.payload, seed=seed, reference=_reference(it),
    )  # fmt: skip


def _observed(it: Simulation) -> list[tuple[int, str]]:
    """Return place in a row of the log and name of every signal that can be observed."""
    keys = layout(it.rig, it.straps, not it.request.ideal)
    return [(i + 1, key) for i, (key, _) in enumerate(keys) if not key.startswith("wearer.")]


def _reference(it: Simulation) -> Callable[[float], dict[str, tuple[float, float]]]:
    position, slope = it.motion.tables()
    q, v = np.empty(9), np.empty(9)
    period, advance, climb = it.motion.period, it.motion.advance, it.motion.climb

    def at(time: float) -> dict[str, tuple[float, float]]:
        reference(time / period, period, advance, climb, position, slope, q, v)
        return {name: (float(q[3 + j]), float(v[3 + j])) for j, name in enumerate(JOINTS)}

    return at


class Outside:
    """The compiled loop with commands from outside.

    Args:
        simulation: What is moved.
        wired: Arguments of `loop.run`; as `loop_wiring.wire` makes them when None.
    """

    def __init__(self, simulation: Simulation, wired: tuple[Any, ...] | None = None) -> None:
        self.simulation = simulation
        self._wired: Any = wire(simulation) if wired is None else wired
        self._drives: Drives = self._wired[5]
        observed = _observed(simulation)
        self._places, self.signals = [place for place, _ in observed], tuple(key for _, key in observed)
        self._kind = ""

    def command(self, commands: user_controller.Commands) -> None:
        """Let commands count from the next step on."""
        if commands.kind != self._kind:
            self._kind = commands.kind
            valves = commands.kind == user_controller.VALVES
            named = self.simulation.request.controller
            settings = self._wired[0]._replace(
                controller=GIVEN if valves else controller_code(named if named in ("pi", "model") else "model"),
                asked=loop.TABLES if valves else loop.TORQUES,
            )
            self._wired = (settings, *self._wired[1:])
        target = self._drives.commands if commands.kind == user_controller.VALVES else self._drives.torques
        n = len(commands.values)
        target[:n] = commands.values
        if n < len(target):  # one command a cylinder moves both sides of a valve with independent edges as a 4-way valve would
            target[n:] = -commands.values

    def run(self, first: int, count: int, rows: Array) -> int:
        """Take steps under the commands; return what became of the gas."""
        arguments = (first, count, *self._wired, rows)
        became: int = loop.run(*arguments)
        return became

    def observation(self, row: Array) -> dict[str, float]:
        """Return a row of the log by names, with "time"."""
        seen = {"time": float(row[0]), **dict(zip(self.signals, row[self._places].tolist()))}
        motion = self.simulation.motion
        if motion.trial is not None:
            seen["gait.phase"] = float(motion.trial.phase_at(row[:1] / motion.period)[0])
        return seen


def asking(simulation: Simulation, asked: user_controller.RunningController, wired: tuple[Any, ...]) -> Advance:
    """Return what moves a run on with a controller asked every so many steps."""
    outside = Outside(simulation, wired)
    every = max(1, round(asked.context.period / simulation.dt))
    last = np.empty(0)

    def advance(first: int, count: int, rows: Array) -> int:
        nonlocal last
        if first == 0:
            asked.reset()
        at = first
        while at < first + count:
            if at > 0 and (at - 1) % every == 0:
                try:
                    outside.command(asked.act(outside.observation(last)))
                except KeyboardInterrupt:
                    if at == first:  # a piece has a row at the least: a step under the commands as they stand
                        outside.run(at, 1, rows[:1])
                    raise user_controller.Interrupted(max(at - first, 1)) from None
            stop = 1 if at == 0 else at + every - (at - 1) % every
            stop = min(stop, first + count)
            became = outside.run(at, stop - at, rows[at - first : stop - first])
            if became:
                rows[stop - first :] = np.nan
                return became
            last = rows[stop - first - 1]
            at = stop
        last = last.copy()
        return 0

    return advance


class Stepper:
    """A simulation that is moved by its user, one command at a time.

    Args:
        simulation: What is moved; its request has `driven` set.

    Attributes:
        rows: The log so far, one array a command.
    """

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self.outside = Outside(simulation)
        self._keys = keys_of(simulation)
        self._watch = simulation.watch()
        self.rows: list[Array] = []
        self.taken = self.first = 0

    def reset(self, start: float = 0.0) -> Array:
        """Put everything back to the start and take the first step; return its row of the log.

        Args:
            start: Where in the cycle of the motion it begins, 0 to 1.
        """
        it = self.simulation
        it.reset()
        self.first = self.taken = round(start * it.motion.period / it.dt)
        if self.first:
            q, v = np.empty(9), np.empty(9)
            position, slope = it.motion.tables()
            period = it.motion.period
            reference(self.first * it.dt / period, period, it.motion.advance, it.motion.climb, position, slope, q, v)
            it.place(q, v)
            atmosphere = it.rig.environment.pressure
            it.plugin.reset(it.data, atmosphere, atmosphere)
        self.outside = Outside(it)
        self.rows = []
        return self.steps(1)

    def steps(self, count: int) -> Array:
        """Take steps under the commands as they stand; return the last row of the log.

        Raises:
            Diverged: as `Simulation.run`.
        """
        rows = np.empty((count, 1 + len(self._keys)))
        with warnings_counted():
            became = self.outside.run(self.taken, count, rows)
        if became:
            try:
                self.simulation.plugin.check(became)
            except Exception as error:
                raise Diverged(str(error)) from None
        if not self._watch.sound(rows[-1], self.taken + count - 1):
            self._watch.check(rows, self.taken)
        self.rows.append(rows)
        self.taken += count
        return rows[-1]

    def walk(self) -> Walk:
        """Return what was simulated since `reset`."""
        return self.as_walk(np.concatenate(self.rows), self.first)

    def piece(self) -> Walk:
        """Return what the last command did."""
        rows = self.rows[-1]
        return self.as_walk(rows, self.taken - len(rows))

    def as_walk(self, rows: Array, first: int) -> Walk:
        """Return rows of the log, the first of them that of a step, as a walk."""
        return walk_of(self.simulation, rows, self._keys, first, True)
