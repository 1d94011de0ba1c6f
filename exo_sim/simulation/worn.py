"""Person, machine, gas and controller put together, and moved."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim import progress
from exo_sim.control import user_controller
from exo_sim.control.causal import Calibration, Causal
from exo_sim.errors import ScenarioError
from exo_sim.gait import scenario as scenarios
from exo_sim.gait.motion import Motion
from exo_sim.gait.residual_reduction import worn
from exo_sim.gait.variation import Variation
from exo_sim.linear_algebra import in_one_thread
from exo_sim.machine import wearer_body
from exo_sim.machine.attachment import attach
from exo_sim.machine.linkage import check_strokes
from exo_sim.machine.person import COORDINATES, Person
from exo_sim.machine.rig_model import check_effects
from exo_sim.machine.straps import fasten
from exo_sim.machine.worn_model import PAYLOAD_LIMIT, build, carry, with_hung
from exo_sim.rig import Rig
from exo_sim.rig.control_step import check_step
from exo_sim.simulation import external_commands, loop, pressure_plans, residual_guideline
from exo_sim.simulation.divergence import WearerWatch
from exo_sim.simulation.loop_wiring import wire
from exo_sim.simulation.mujoco_calls import warnings_counted
from exo_sim.simulation.plugin import PneumaticPlugin
from exo_sim.simulation.torque_driven_wearer import embody
from exo_sim.simulation.walk import Request, Walk
from exo_sim.simulation.wearer_load import prescribed_alone
from exo_sim.simulation.worn_demand import LOOKED_AT, rehearsed_demand
from exo_sim.simulation.worn_log import keys_of, walk_of

_CHUNK = 250
#: Rows of a piece of a long run, and whole cycles in it at the least: those that a summary leaves out, and one more.
MOST_ROWS, FEWEST_CYCLES = 1 << 15, 3
#: A rehearsal leaves out so many cycles or so much time [s] at its start.
_SETTLING, _SETTLING_TIME = 2, 2.0


class Simulation:
    """Person, machine, gas and controller put together; `run` moves them.

    Args:
        rig: A worn machine; its wearer and ankle settings are used.
        request: What to simulate.
        controller: Somebody's own, loaded by `control.user_controller`; None for the built-in one that the request names.
        seed: Where the noise of gauges starts, and what such a controller is given.

    Attributes:
        calibration: What a causal controller begins with, where one was asked for.
        torques: Planned for a wearer who moves by them, shape (n, 8); None for one whose motion is prescribed.
        intended: What a wearer means to do, n samples; one who is a body does `motion`, which has his soles in the ground.
        expected: What he expects the straps to do to his segments, about their upper joints, shape (n, 7, 3).
        remarks: Plain sentences, such as that the cylinders cannot carry the payload.
        unreliable: Why the wearer's moments are not to be relied on, the first of the remarks; None where they are.

    Raises:
        ModelError, RigError, ScenarioError: the machine cannot be built, or cannot do this.
    """

    @in_one_thread
    def __init__(self, rig: Rig, request: Request, controller: user_controller.Controller | None = None, seed: int = 0):
        self.rig, self.request = rig, request
        self.seed = seed
        self._asked: user_controller.RunningController | None = None
        self.person = Person(rig.wearer.height, rig.wearer.mass)
        scenario = request.found
        self.plain = scenarios.motion(scenario, self.person, request.speed)
        self.unreliable = self._unreliable() if scenario.doubts is not None else None
        self.cycles = request.cycles if request.cycles is not None else scenario.cycles
        self.masses = with_hung(rig, scenario.hung)
        self.model = self.built(request.payload)
        attach(self.model, rig)
        whole = worn(self.plain, self.person, self.model)
        self.motion = whole if whole.trial is None else whole.trial.mean  # on which torques are planned
        if request.step is not None:
            self.model.opt.timestep = request.step
        self.added = scenario.added
        if self.added and request.payload + self.added.mass > PAYLOAD_LIMIT + 20.0:
            raise ScenarioError(f"payload {request.payload:g} kg and {self.added.mass:g} kg more: too much to carry")
        check_strokes(rig, self.model)
        check_effects(rig, self.model)
        self.data = mujoco.MjData(self.model)
        self.straps = fasten(self.model, self.person)
        self.frame_mass = float(self.built(0.0).body_subtreemass[self.model.body("torso").id])
        self.plugin = PneumaticPlugin(self.model, rig)
        if request.assist == "on" and not request.ideal:
            check_step(rig, float(self.model.opt.timestep))
        self.dt = float(self.model.opt.timestep)
        self.remarks: tuple[str, ...] = ()
        self.torques: NDArray[np.float64] | None = None
        self.calibration: Calibration | None = None
        if self.motion.from_rest and request.law == "causal":
            raise ScenarioError(f'{request.scenario}: demand "causal" goes by the phase of a stride that comes again; write another demand')
        self.demand = self.demand_added = np.zeros((len(self.motion.position) + 1, 6))
        self.plan = self.plan_added = pressure_plans.nothing(len(self.plugin.links))
        self.demand, self.remarks = rehearsed_demand(self, request.payload)
        self.demand_added = self.demand
        if self.added and request.law != "causal":
            self.demand_added, self.remarks = rehearsed_demand(self, request.payload + self.added.mass)
        self.lay_plans()
        if (variation := request.variation or scenario.variation) is not None:
            whole = self._varied(whole, variation)
        self.motion = whole
        if whole.trial is not None:
            self.plan, self.plan_added = (pressure_plans.played(plan, whole.trial, self.plugin) for plan in (self.plan, self.plan_added))
            self.demand, self.demand_added = whole.trial.played(self.demand), whole.trial.played(self.demand_added)
        self.intended, self.expected = whole, np.zeros((len(whole.position), 7, 3))
        if request.moved_by == "torques":
            embody(self, LOOKED_AT)
        self.remarks = (*filter(None, [self.unreliable]), *scenario.remarks, *self.remarks)
        if controller is not None:
            self.controlled_by(controller, seed)
        elif self.calibration is not None:
            self.controlled_by(Causal(self.calibration), seed)
        self.reset()

    def _unreliable(self) -> str | None:
        doubts = self.request.found.doubts or ()
        return residual_guideline.unreliable(self.request.scenario, prescribed_alone(self.plain, self.person).ground.residual, doubts)

    def built(self, payload: float) -> mujoco.MjModel:
        """Return the model with a payload [kg] on the ground that is walked on."""
        rig = self.rig
        length = self.plain.advance * (self.cycles + 1)
        return build(
            rig.model, self.person, payload, rig.ankle, self.masses, rig.joint_factors, ground=self.plain.ground, length=length
        )

    def _varied(self, motion: Motion, variation: Variation) -> Motion:
        """Return the motion with strides that differ from the mean one, on which torques were planned."""
        if motion.trial is not None:
            raise ScenarioError(f"{self.request.scenario}: the strides of a whole trial are as they were recorded; leave out the variation")
        if motion.from_rest:
            raise ScenarioError(f"{self.request.scenario}: its strides follow from where it begins and ends; leave out the variation")
        varied = variation.applied(motion, self.cycles)
        if varied.trial is not None:
            self.cycles = math.ceil(self.cycles / varied.trial.strides)
        return varied

    @property
    def settling(self) -> int:
        """How many cycles at the start of a rehearsal are left out."""
        return min(_SETTLING, max(1, math.ceil(_SETTLING_TIME / self.motion.period)))

    def controlled_by(self, controller: user_controller.Controller, seed: int = 0) -> None:
        """Let somebody's controller ask for torques or move the valves.

        Args:
            controller: Whose.
            seed: What it is given.
        """
        context = external_commands.context(self, controller, seed)
        self._asked = user_controller.RunningController(controller, context, self.request.controller)

    def left_alone(self) -> None:
        """Let nobody's controller ask for anything: the demand is played."""
        self._asked = None

    @property
    def planned(self) -> bool:
        """Whether the chambers follow a plan now: one is made for the demand's own phases, which nobody else's torques keep to."""
        return self.plans_chambers and self._asked is None

    @property
    def plans_chambers(self) -> bool:
        """Whether the chambers of this machine follow a plan."""
        asked = self.request
        within = asked.assist == "on" and asked.controller == "model" and not asked.ideal and not asked.driven
        return within and pressure_plans.planned(self.plugin) and not self.motion.from_rest

    def lay_plans(self) -> None:
        """Plan the pressures of cylinders whose valves have independent edges for the demand as it stands."""
        asked = self.request
        if not self.plans_chambers:
            return
        self.plan = pressure_plans.pressures(self.plugin, self.motion, self.demand, asked.gains.preview)
        added = self.demand_added is not self.demand
        self.plan_added = pressure_plans.pressures(self.plugin, self.motion, self.demand_added, asked.gains.preview) if added else self.plan

    def reset(self) -> None:
        """Put the machine on the person at phase zero, moving with it, gas at rest at the pressures that hold it."""
        model, data = self.model, self.data
        mujoco.mj_resetData(model, data)
        self.place(self.motion.position[0], self.motion.slope[0] / self.motion.period)
        vented = self.request.assist == "vented"
        self.plugin.pneumatics.cylinders["vented"] = float(vented)
        atmosphere = self.rig.environment.pressure
        self.plugin.reset(data, atmosphere, atmosphere)

    def place(self, q: NDArray[np.float64], v: NDArray[np.float64]) -> None:
        """Put the machine, and a wearer who is a body, to coordinates and rates, shape (9,)."""
        n = len(COORDINATES)
        self.data.qpos[:n], self.data.qvel[:n] = q, v
        if self.torques is not None:
            dofs = wearer_body.find(self.model).dofs[:n]
            self.data.qpos[dofs], self.data.qvel[dofs] = q, v

    def run(self, quiet: bool = True) -> Walk:
        """Simulate, and return all of it.

        Raises:
            Diverged: numbers that mean nothing any more, a warning of MuJoCo, or a fall.
        """
        (walk,) = self.pieces(quiet, most=None)
        return walk

    def pieces(
        self, quiet: bool = True, most: int | None = MOST_ROWS, stop: Callable[[], bool] = lambda: False
    ) -> Iterator[Walk]:
        """Simulate, and give pieces of whole cycles as they are done: no more than one of them is in memory here.

        Args:
            quiet: No progress.
            most: Rows of a piece, where that leaves it `FEWEST_CYCLES` or more; None for all in one.
            stop: Asked between steps; once it says True, what was done since the last piece is the last one.

        Raises:
            Diverged: as `run`.
        """
        total = self.rows
        per_cycle = self.motion.period / self.dt
        cycles = self.cycles if most is None else max(FEWEST_CYCLES, int(most / per_cycle))
        keys = keys_of(self)
        wired, watch = wire(self), self.watch()
        advance: external_commands.Advance = lambda first, count, rows: loop.run(first, count, *wired, rows)  # noqa: E731
        if self._asked is not None:
            advance = external_commands.asking(self, self._asked, wired)
        begun = done = 0
        interrupted = False
        with self._payload_put_back(), progress.Bar(total * self.dt, self.request.scenario, unit="s", quiet=quiet) as bar:
            while done < total and not interrupted:
                end = round((round(begun / per_cycle) + cycles) * per_cycle)
                if total - end <= per_cycle + 1:  # what is left would not make a piece of its own
                    end = total
                log = np.empty((end - begun, 1 + len(keys)))
                while done < end and not interrupted:
                    count = min(_CHUNK, end - done)
                    rows = log[done - begun : done - begun + count]
                    try:
                        with warnings_counted():
                            self.plugin.check(advance(done, count, rows))
                    except user_controller.Interrupted as cut:
                        if not stop():
                            raise KeyboardInterrupt from None
                        count, rows = cut.rows, rows[: cut.rows]
                    watch.check(rows, done)
                    done += count
                    bar.to(done * self.dt)
                    interrupted = stop() and done < total
                yield walk_of(self, log[: done - begun], keys, begun, interrupted)
                begun = done
        if self._asked is not None:
            self.remarks = (*self.remarks, *self._asked.remarks())

    @property
    def rows(self) -> int:
        """How many rows a whole run has."""
        return math.ceil(self.cycles * self.motion.period / self.dt - 1e-9) + 1

    @contextmanager
    def _payload_put_back(self) -> Iterator[None]:
        """Put the payload back to what it was at the start, for the next run."""
        try:
            yield
        finally:
            if self.added:
                carry(self.model, self.request.payload)

    @property
    def added_at(self) -> float:
        """When the added load is put on [s]: the same share of the run as in the scenario's own length."""
        assert self.added is not None
        usual = self.request.found.cycles
        asked = self.request.cycles if self.request.cycles is not None else usual
        return self.added.at * self.motion.stride_time * asked / usual

    def watch(self) -> WearerWatch:
        """Return what tells whether rows of the log are of a machine that is on its wearer."""
        keys = ("time", *(key for key, _ in keys_of(self)))
        return WearerWatch(self.request.scenario, self.data, self.motion, self.dt, keys)
