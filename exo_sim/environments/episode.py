"""One episode of walking under commands: what is acted, observed and rewarded, for every interface the same.

Reward: 1 less the extra moments that the machine imposes on the wearer's hips, knees and ankles, relative to those of the same payload
carried as a backpack (root mean square over the six joints and over the control step, at most 2). A machine that nobody feels earns 1 a
step, one that is no better than a backpack 0; a fall earns -10 and ends the episode.
"""

from __future__ import annotations

import math
import os
from collections import OrderedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from exo_sim import rig as rigs
from exo_sim import units
from exo_sim.control import user_controller
from exo_sim.errors import Diverged, ScenarioError, nearest
from exo_sim.machine.person import SEGMENTS
from exo_sim.machine.wearer_moments import extra_moments
from exo_sim.rig import Rig
from exo_sim.rig.included_machines import rig_file
from exo_sim.simulation.external_commands import Stepper
from exo_sim.simulation.loop import person_along
from exo_sim.simulation.walk import JOINTS, Request, Walk, default_rig, layout
from exo_sim.simulation.wearer_load import by_backpack
from exo_sim.simulation.worn import Simulation

Array = NDArray[np.float64]

ACTIONS = ("torques", "valves")
#: Joint torque of an action of 1 [N m].
TORQUE = 120.0
#: Reward of a fall, and the most that a step's loads take off.
FALL, MOST = -10.0, 2.0
#: What observations are divided by, so that they are about 1.
_RATE, _FORCE, _HEIGHT = 5.0, 200.0, 0.1
#: Loads are looked at in every so many steps of the simulation; a backpack counts as at least this much [N m].
_EVERY, _LEAST_LOAD = 5, 5.0


class Episode:
    """A machine on its wearer, moved by actions.

    Args:
        scenario: Name of a scenario or path of a scenario file.
        rig: The worn machine, its file, or the name of an included one; the one that comes with the package when None.
        payload: On the back: kilograms, or text with a unit.
        speed: Factor on the recorded cadence, or text like "1.3 m/s".
        actions: "torques": of hips and knees and of powered ankles, 1 is `TORQUE`, made by the model-based valve controller; "valves":
            their commands.
        control_timestep: Time between two actions [s].
        time_limit: Of an episode [s].
        random_start: Begin at a random phase of the cycle; else at its beginning.
        seed: Where chance starts.

    Attributes:
        action_names: What each number of an action moves.
        observation_names: Group of the observation to what its numbers are.

    Raises:
        ScenarioError, ModelError, RigError, UnitError: it cannot be; one line each.
    """

    def __init__(
        self, scenario: str = "level_walk", *, rig: Rig | str | os.PathLike[str] | None = None, payload: float | str = 34.0,
        speed: float | str = 1.0, actions: str = "torques", control_timestep: float = 0.02, time_limit: float = 5.0,
        random_start: bool = True, seed: int | None = None,
    ) -> None:  # fmt: skip
        if actions not in ACTIONS:
            raise ScenarioError(f'actions "{actions}"{nearest(actions, ACTIONS)}')
        machine = rig if isinstance(rig, Rig) else rigs.read(rig_file(rig) if rig is not None else default_rig())
        mass = float(payload) if isinstance(payload, int | float) else units.parse(payload, "kg")
        request = Request(scenario, payload=mass, speed=speed, cycles=10000, controller="environment", driven=actions)
        self.simulation = Simulation(machine, request)
        self.timestep = self.simulation.dt
        self.substeps = round(control_timestep / self.timestep)
        if self.substeps < 1 or abs(self.substeps * self.timestep - control_timestep) > 1e-9:
            raise ScenarioError(f"control_timestep = {control_timestep:g} s: write a multiple of the model's {self.timestep:g} s")
        if not control_timestep <= time_limit < math.inf:
            raise ScenarioError(f"time_limit = {time_limit:g} s: write a time of at least one control step ({control_timestep:g} s)")
        self.control_timestep, self.time_limit, self.random_start = control_timestep, time_limit, random_start
        self.steps_limit = round(time_limit / control_timestep)
        self._kind = user_controller.TORQUES if actions == "torques" else user_controller.VALVES
        self._driven = self._driven_joints(machine)
        cylinders = list(machine.cylinders)
        self.action_names = tuple(f"{JOINTS[j]}.torque" for j in self._driven) if actions == "torques" else tuple(
            f"{name}.valve_command" for name in cylinders)  # fmt: skip
        self._stepper = Stepper(self.simulation)
        self._keys = [key for key, _ in layout(machine, self.simulation.straps, True)]
        self._place = {key: i + 1 for i, key in enumerate(self._keys)}
        self._wrench = [self._place[f"wearer.{segment}_{part}"] for segment in SEGMENTS for part in ("x", "z", "moment")]
        self._groups = self._observed(cylinders)
        self.observation_names = OrderedDict((group, tuple(name for name, *_ in parts)) for group, parts in self._groups.items())
        self._picks = {
            group: ([self._place[key] for _, key, _, _ in parts], np.array([z for *_, z, _ in parts]), np.array([s for *_, s in parts]))
            for group, parts in self._groups.items()
        }
        self.random = np.random.default_rng(seed)
        self._backpack = 1.0
        self._row = self._stepper.reset()
        cycle = self._cycle()
        self._backpack = float(np.sqrt(np.mean(by_backpack(cycle) ** 2)))
        self._backpack = max(self._backpack, _LEAST_LOAD)
        self.fallen = False
        self.steps = 0

    def _driven_joints(self, rig: Rig) -> list[int]:
        moved = {link.dof - 3 for link in self.simulation.plugin.links}
        return [j for j in range(6) if j in moved or (j % 3 == 2 and rig.ankle.mode == "powered")]

    def _observed(self, cylinders: list[str]) -> OrderedDict[str, list[tuple[str, str, float, float]]]:
        """Return group to name, column, zero and scale of each number."""
        height = float(self.simulation.motion.position[:, 1].mean())
        supply, atmosphere = self.simulation.rig.supply.pressure, self.simulation.rig.environment.pressure
        straps = self.simulation.straps.names
        return OrderedDict(
            joints=[(f"{name}.position", f"{name}.position", 0.0, 1.0) for name in JOINTS],
            velocities=[(f"{name}.velocity", f"{name}.velocity", 0.0, _RATE) for name in JOINTS],
            torso=[
                ("torso_z.position", "torso_z.position", height, _HEIGHT), ("torso_pitch.position", "torso_pitch.position", 0.0, 1.0),
                ("torso_z.velocity", "torso_z.velocity", 0.0, 1.0), ("torso_pitch.velocity", "torso_pitch.velocity", 0.0, _RATE),
            ],
            straps=[(f"{n}.strap_force_{a}", f"{n}.strap_force_{a}", 0.0, _FORCE) for n in straps for a in "xz"],
            stance=[(f"gait.stance_{side}", f"gait.stance_{side}", 0.0, 1.0) for side in "lr"],
            pressures=[
                (f"{n}.pressure_{c}", f"{n}.pressure_{c}", atmosphere, supply - atmosphere) for n in cylinders for c in (1, 2)
            ],
        )  # fmt: skip

    def reset(self) -> OrderedDict[str, Array]:
        """Begin an episode; return the first observation."""
        start = float(self.random.uniform()) if self.random_start else 0.0
        self._row = self._stepper.reset(start)
        self.fallen, self.steps = False, 0
        return self.observation()

    def observation(self) -> OrderedDict[str, Array]:
        """Return the observation by groups: `observation_names`, and "phase" as sine and cosine."""
        out = OrderedDict((group, (self._row[place] - zero) / scale) for group, (place, zero, scale) in self._picks.items())
        turn = 2.0 * np.pi * self._row[self._place["gait.phase"]]
        out["phase"] = np.array([np.sin(turn), np.cos(turn)])
        return out

    def step(self, action: ArrayLike) -> float:
        """Act for one control step; return its reward. `fallen` tells whether it ended in a fall.

        Args:
            action: -1 to 1, in the order of `action_names`; more counts as that.
        """
        given = np.clip(np.nan_to_num(np.asarray(action, dtype=np.float64)), -1.0, 1.0)
        values = given
        if self._kind == user_controller.TORQUES:
            values = np.zeros(6)
            values[self._driven] = TORQUE * given
        self._stepper.outside.command(user_controller.Commands(self._kind, values))
        self.steps += 1
        try:
            self._row = self._stepper.steps(self.substeps)
        except Diverged:
            self.fallen = True
            return FALL
        extra = self._moments(self._stepper.rows[-1][:: -_EVERY])
        return 1.0 - min(float(np.sqrt(np.mean(extra * extra))) / self._backpack, MOST)

    def _moments(self, rows: Array) -> Array:
        """Return the wearer's extra moments at some rows of the log [N m], shape (n, 6)."""
        motion, person = self.simulation.motion, self.simulation.person
        at = np.rint(rows[:, self._place["gait.phase"]] * len(motion.share)).astype(int) % len(motion.share)
        poses, wrench = person_along(rows[:, 0], motion, person), rows[:, self._wrench].reshape(len(rows), 7, 3)
        return extra_moments(poses, wrench, motion.share[at], motion.pressure_centre[at], person.ankle_height) * motion.support[at, None]

    def _cycle(self) -> Walk:
        """Return one cycle of the wearer's motion as a walk, for the loads of a backpack."""
        rows = np.tile(self._row, (round(self.simulation.motion.period / self.timestep), 1))
        return self._stepper.as_walk(rows, 0)

    def flat(self, observation: OrderedDict[str, Array]) -> Array:
        """Return an observation as one vector."""
        return np.concatenate(list(observation.values()))
