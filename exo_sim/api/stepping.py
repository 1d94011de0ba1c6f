"""`exo.Simulation`: a person in the machine, moved step by step under your own commands."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from exo_sim.api.arguments import Quantity, RigLike, payload_of, quantity, rig_of
from exo_sim.api.recording import Recording
from exo_sim.api.rig import Rig
from exo_sim.errors import ScenarioError


class Simulation:
    """A worn machine between two commands.

        simulation = exo.Simulation(rig, "level_walk", payload="34 kg")
        while not simulation.done:
            observation = simulation.step({"knee_l.torque": 20.0})

    Args:
        rig: A path or `exo.Rig` of a worn machine; the one that comes with the package when None.
        scenario: One of `exo.scenarios()`, a scenario file, or a gait file.
        payload: On the back: kilograms, or text with a unit; what the rig's `[bodies.payload]` says when None, or else 34 kg.
        speed: Factor on the recorded cadence, or text like "1.3 m/s".
        strides: How many strides or repetitions until `done`; the scenario's own number when None.
        period: Time that a command lasts: seconds, or text with a unit.

    Attributes:
        rig: The machine.
        observation: Every signal of the contract by name, with "time" [s]; SI.

    Raises:
        ScenarioError, RigError, ModelError: it cannot be carried out; one line each.
    """

    def __init__(
        self, rig: RigLike | None = None, scenario: str = "level_walk", *, payload: Quantity | None = None, speed: float | str = 1.0,
        strides: int | None = None, period: Quantity = 0.002,
    ) -> None:  # fmt: skip
        from exo_sim.control import user_controller
        from exo_sim.simulation import external_commands
        from exo_sim.simulation.walk import JOINTS, Request
        from exo_sim.simulation.worn import Simulation as Coupled

        self.rig: Rig = rig_of(rig)
        request = Request(
            scenario, payload=payload_of(self.rig, payload), speed=speed, cycles=strides, controller="steps", driven="valves"
        )
        self._coupled = Coupled(self.rig, request)
        self.remarks = self._coupled.remarks
        self._stepper = external_commands.Stepper(self._coupled)
        step = self._coupled.dt
        seconds = quantity(period, "s", "period", low=step, high=1.0)
        self._substeps = max(1, round(seconds / step))
        self.duration = self._coupled.cycles * self._coupled.motion.period
        self._context = user_controller.Context(
            self.rig, tuple(self.rig.cylinders), JOINTS, self._stepper.outside.signals, self._substeps * step, step, self.duration
        )
        self._kind = ""
        self.observation: dict[str, float] = {}
        self.reset()

    def reset(self) -> dict[str, float]:
        """Put the machine on the wearer at the start of the motion; return the first observation."""
        self._kind = ""
        self.observation = self._stepper.outside.observation(self._stepper.reset())
        self.__dict__.pop("recording", None)
        return self.observation

    def step(self, commands: Any = None, steps: int | None = None) -> dict[str, float]:
        """Let commands act for one period; return what was observed at the beginning of its last step.

        Args:
            commands: As `act` of a controller returns them: `{"knee_l": 0.5}` opens a valve, `{"knee_l.torque": 20.0}` asks for a joint's
                torque [N m], numbers are valve commands in the order of the rig's cylinders. None leaves them as they are.
            steps: Steps of the simulation instead of one period.

        Raises:
            ScenarioError: no such cylinder or joint, or no number.
            Diverged: the machine fell, or the numbers mean nothing any more.
        """
        from exo_sim.control import user_controller

        if commands is not None:
            read = user_controller.read(commands, self._context, self._kind)
            self._kind = read.kind
            self._stepper.outside.command(read)
        count = self._substeps if steps is None else steps
        if isinstance(count, bool) or not isinstance(count, int) or count < 1:
            raise ScenarioError(f"steps = {count!r}: write a whole number from 1 on")
        self.observation = self._stepper.outside.observation(self._stepper.steps(count))
        self.__dict__.pop("recording", None)
        return self.observation

    @property
    def time(self) -> float:
        """Return how far the simulation has come [s]."""
        return self._stepper.taken * self._coupled.dt

    @property
    def done(self) -> bool:
        """Return whether the scenario's strides are over; stepping on is possible."""
        return self.time >= self.duration

    @cached_property
    def recording(self) -> Recording:
        """Return every signal since `reset`, as the rig's sensors show it."""
        from exo_sim.simulation import record

        return Recording.of(record.recording(self._stepper.walk(), self._coupled.request.scenario))

    @property
    def summary(self) -> dict[str, Any]:
        """Return what `exo-sim run --json` prints of what was simulated since `reset`, without file names and times."""
        from exo_sim.simulation.summary import summarise

        return summarise(self._stepper.walk())

    def __repr__(self) -> str:
        return f"<exo.Simulation {self._coupled.request.scenario} in {self.rig.name} at {self.time:.3f} s>"
