"""A controller in use: when it is asked, and what it does wrong in one line."""

from __future__ import annotations

from collections.abc import Mapping
from types import FrameType

import numpy as np

from exo_sim.control.user_controller import faults
from exo_sim.control.user_controller.commands import VALVES, Commands, read
from exo_sim.control.user_controller.protocol import Context, Controller
from exo_sim.errors import ScenarioError, near, nearest


class Interrupted(KeyboardInterrupt):
    """Ctrl-C while `act` was at work; `rows` steps of those that were to be taken are done."""

    def __init__(self, rows: int) -> None:
        super().__init__()
        self.rows = rows


class RunningController:
    """A controller in use: its calls, what it returns, and what it does wrong in one line.

    Args:
        controller: What somebody brought.
        context: What it gets.
        source: What to call it in messages.
    """

    def __init__(self, controller: Controller, context: Context, source: str = "") -> None:
        self.controller, self.context = controller, context
        self.source = source or type(controller).__name__
        self.kind = ""
        self.clipped = 0

    def reset(self) -> None:
        """Let it begin anew.

        Raises:
            ScenarioError: it fails; the message names file and line.
        """
        self.kind, self.clipped = "", 0
        try:
            self.controller.reset(self.context)
        except BaseException as error:
            if faults.is_interrupt(error):
                raise
            raise ScenarioError(f"controller {faults.place(error)}, in reset of {self.source}") from None

    def act(self, observation: Mapping[str, float]) -> Commands:
        """Ask for commands.

        Raises:
            ScenarioError: it fails, or what it returns is none; the message names file and line, or command and time.
        """
        time = observation["time"]  # before somebody's code has the dictionary
        try:
            returned = self.controller.act(observation)
        except BaseException as error:
            if faults.is_interrupt(error):
                raise
            where = f"in act of {self.source} at {time:.3f} s"
            raise ScenarioError(f"controller {faults.place(error)}, {where}{self._meant(error)}") from None
        try:
            commands = read(returned, self.context, self.kind)
        except ScenarioError as error:
            raise ScenarioError(f"controller {self.source}, at {time:.3f} s: {error}") from None
        except Exception as error:  # of the objects in it, when they are asked for a number or a name
            raise ScenarioError(
                f"controller {self.source}, at {time:.3f} s: what act returned cannot be read ({faults.described(error)}); "
                'return a dictionary of numbers like {"knee_l": 0.5}'
            ) from None
        self.kind = commands.kind
        if commands.kind == VALVES:
            self.clipped += int(np.abs(commands.values).max(initial=0.0) > 1.5)
        return commands

    def _meant(self, error: BaseException) -> str:
        """Return which signals or joints a name that is not there may mean; "" where it is nobody's."""
        name = error.args[0] if isinstance(error, KeyError) and error.args else None
        if not isinstance(name, str) or name in self.context.signals or name in self.context.joints:
            return ""
        if "." not in name:
            return nearest(name, self.context.joints)
        return nearest(name, self.context.signals) if near(name, self.context.signals) else ""

    @classmethod
    def is_asked(cls, frame: FrameType | None) -> bool:
        """Return whether a frame, as a signal's handler is given, belongs to somebody's code at work."""
        return faults.is_within(frame, cls.reset.__code__, cls.act.__code__)

    def remarks(self) -> tuple[str, ...]:
        """Return what is worth saying after a run."""
        if self.clipped < 10:
            return ()
        return (
            f"controller {self.source}: {self.clipped} commands to valves were beyond -1 to 1 and counted as that; if they were meant as "
            'torques, return them as "knee_l.torque"',
        )
