"""The pneumatics as a plug-in of MuJoCo: `reset`, `compute`, `advance` over `mjModel` and `mjData`."""

from __future__ import annotations

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ModelError, RigError
from exo_sim.machine import mjcf
from exo_sim.machine.linkage import check_motors, linkages, moment_row
from exo_sim.machine.rig_model import check_places
from exo_sim.physics.conservation import Books
from exo_sim.physics.plant import FOLLOWED
from exo_sim.rig import Rig, assembly
from exo_sim.rig.schema import LARGEST_HEAT_CAPACITY_RATIO, LARGEST_PRESSURE
from exo_sim.simulation import views
from exo_sim.simulation.bound_arrays import Bound, straight, take_step
from exo_sim.simulation.coupled_step import CLOCK_SLACK, OUT_OF_STEP, advance_gas, compute_forces, freshen_levers
from exo_sim.simulation.snapshot import Snapshot

_NOTHING = object()


class PneumaticPlugin:
    """Cylinders of a rig on a MuJoCo model.

    The loop is

        mujoco.mj_step1(model, data)    # positions and transmission lengths of now
        plugin.advance(data)            # the gas catches up: from where the pistons were to where they are
        plugin.command[:] = ...         # held until the next step
        plugin.compute(data)            # rod forces into data.ctrl
        mujoco.mj_step2(model, data)

    and `step(data)` is its short form. Pistons move evenly within a step, so the gas does exactly the work that their motion asks.

    Attributes:
        pneumatics: The gas: state vector, records, books.

    Args:
        model: The MuJoCo model.
        rig: The machine whose cylinders drive it.

    Raises:
        ModelError: the model lacks an actuator or joint of the rig, or holds numbers that no machine has.
        RigError: a gas that cannot be.
    """

    def __init__(self, model: mujoco.MjModel, rig: Rig):
        self.model, self.rig = model, rig
        mjcf.check(model, rig.model, rig.joint_factors)
        if not 1.0 < rig.heat_capacity_ratio <= LARGEST_HEAT_CAPACITY_RATIO or not 0.0 < rig.specific_gas_constant < math.inf:
            raise RigError(
                f"{rig.path}: no gas has heat_capacity_ratio = {rig.heat_capacity_ratio:g} and specific_gas_constant = "
                f"{rig.specific_gas_constant:g} J/(kg K)"
            )
        self.links = linkages(rig, model)
        check_places(rig, model)
        self.joint_names = names = assembly.joints_with_effects(rig)
        self.dt = float(model.opt.timestep)
        drives = {link.cylinder: link.joint for link in self.links}
        self.pneumatics = assembly.pneumatics(rig, self.dt, names, drives)
        ids = [model.joint(name).id for name in names]
        self.plant = views.plant(
            self.pneumatics,
            actuators=np.array([link.actuator for link in self.links], dtype=np.int64),
            driven=np.array([link.dof for link in self.links], dtype=np.int64),
            retracted=np.array([rig.cylinders[link.cylinder].retracted_length for link in self.links]),
            dofs=np.array([model.jnt_dofadr[i] for i in ids], dtype=np.int64),
            addresses=np.array([model.jnt_qposadr[i] for i in ids], dtype=np.int64),
            turning=any(effect.turning for effect in rig.effects),
        )
        self._stepped: object = _NOTHING  # what `step` was last called with, and the call for it
        self._bound: Bound | None = None
        self._places, self._take_step = (0, 0), take_step

    def __getstate__(self) -> dict[str, object]:
        return {**self.__dict__, "_bound": None, "_stepped": _NOTHING, "_take_step": None}  # a copy's arrays are elsewhere

    def refit(self, rig: Rig) -> None:
        """Take the numbers of another rig: the same cylinders on the same actuators, with other sizes, supply or effects' values.

        The arrays stay where they are. Call `reset` next; attachment points are the model's (`machine.attachment.attach`).

        Raises:
            ModelError: one of both has a recovery tank.
        """
        if (rig.recovery is None) != (self.rig.recovery is None):
            raise ModelError(f"{rig.path}: with or without a recovery tank is another machine: make a plug-in of its own for it")
        drives = {link.cylinder: link.joint for link in self.links}
        other = assembly.pneumatics(rig, self.dt, self.joint_names, drives)
        self.rig = rig
        self.pneumatics.world[:], self.pneumatics.cylinders[:] = other.world, other.cylinders
        self.pneumatics.joints[:] = other.joints
        self.plant.retracted[:] = [rig.cylinders[link.cylinder].retracted_length for link in self.links]

    @property
    def command(self) -> NDArray[np.float64]:
        """Valve commands, -1 to 1, one a cylinder in the rig's order, shape (n,).

        `advance` takes the gas through the step that has passed with what stands here then.
        Of a valve with independent edges it is the command towards chamber 1.
        """
        return self.plant.command[: len(self.links)]

    @command.setter
    def command(self, value: NDArray[np.float64]) -> None:
        self.plant.command[: len(self.links)] = value

    @property
    def command_2(self) -> NDArray[np.float64]:
        """Commands towards chambers 2 of valves with independent edges, shape (n,); shape (0,) where the rig has none of these."""
        return self.plant.command[len(self.links) : 2 * len(self.links)]

    @command_2.setter
    def command_2(self, value: NDArray[np.float64]) -> None:
        self.plant.command[len(self.links) : 2 * len(self.links)] = value

    @property
    def force(self) -> NDArray[np.float64]:
        """Rod forces of the last `compute`, shape (n,) [N]; + pushes out."""
        return self.plant.force

    @property
    def lengths(self) -> NDArray[np.float64]:
        """Piston positions X as the joints have them, shape (n,) [m]."""
        return self.plant.x

    def pressures(self) -> NDArray[np.float64]:
        """Return both chamber pressures of each cylinder, shape (n, 2) [Pa]."""
        return self.pneumatics.pressures(self.plant.x)

    def books(self) -> Books:
        """Return what passed through since `reset`, and what the books cannot account for."""
        return self.pneumatics.books()

    def reset(
        self,
        data: mujoco.MjData,
        pressure_1: NDArray[np.float64] | float | None = None,
        pressure_2: NDArray[np.float64] | float | None = None,
    ) -> None:
        """Fill the chambers with gas at rest, at the atmosphere unless pressures [Pa] are given, for the positions in `data`.

        Raises:
            ModelError: `data` is of another model, the model's time step or motors were edited since the plug-in was made, a piston is a
                stroke or more outside its stroke, or a pressure is none: absolute ones are above 0, and below `LARGEST_PRESSURE`.
        """
        self._check_data(data)
        self._check_time_step()
        check_motors(self.rig, self.model, self.links)
        atmosphere = self.rig.environment.pressure
        p_1 = self._pressure("pressure_1", atmosphere if pressure_1 is None else pressure_1)
        p_2 = self._pressure("pressure_2", atmosphere if pressure_2 is None else pressure_2)
        mujoco.mj_forward(self.model, data)
        plant = self.plant
        plant.x[:] = data.actuator_length[plant.actuators] - plant.retracted
        for link, x in zip(self.links, plant.x):
            stroke = self.rig.cylinders[link.cylinder].stroke
            if not -stroke <= x <= 2.0 * stroke and math.isfinite(x):
                raise ModelError(
                    f"{self.rig.path}: cylinder {link.cylinder}: its piston is at {x:g} m, its stroke is {stroke:g} m: start within it, or "
                    "correct retracted_length"
                )
        plant.q[:] = data.qpos[plant.addresses]
        plant.felt[:] = plant.command[:] = 0.0
        self._masses(data)
        self.pneumatics.fill(plant.x, p_1, p_2)
        self.pneumatics.settle_transmission(plant.x)
        plant.clock[[views.GAS_TIME, views.STEPPED]] = data.time, 0.0

    def _pressure(self, name: str, value: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """Return a pressure for each cylinder, shape (n,); how small it may be is asked where the chambers are filled."""
        try:
            pressures = np.broadcast_to(np.asarray(value, dtype=np.float64), (len(self.links),))
        except (TypeError, ValueError, OverflowError):
            raise ModelError(f"{name}: give one pressure in Pa, or one for each of {len(self.links)} cylinders") from None
        if (most := np.max(pressures, initial=0.0)) > LARGEST_PRESSURE and most < np.inf:
            raise ModelError(f"{self.rig.path}: {name} = {most:g} Pa at the start is more than any machine has, {LARGEST_PRESSURE:g} Pa")
        return pressures

    def _check_data(self, data: mujoco.MjData) -> None:
        """Refuse the state of another model: its arrays have other lengths or other meanings."""
        if not isinstance(data, mujoco.MjData):
            raise ModelError(f"the plug-in takes the MjData of its model, not {type(data).__name__}")
        if data.signature != self.model.signature:
            raise ModelError("the MjData belongs to another model than the one that the plug-in was made for")

    def _check_time_step(self) -> None:
        """Refuse a model whose time step was edited: the gas is followed at the one that the plug-in was made for."""
        if (step := float(self.model.opt.timestep)) != self.dt:
            raise ModelError(f"the model's time step became {step:g} s; the plug-in was made for {self.dt:g} s: make it anew for this one")

    def _masses(self, data: mujoco.MjData) -> None:
        """Set the mass that each dry contact holds: the inverse of J M^-1 J'."""
        for i, link in enumerate(self.links):
            row = moment_row(self.model, data, link.actuator)
            self.pneumatics.cylinders[i]["arm"] = row[link.dof]
            self.pneumatics.cylinders[i]["effective_mass"] = 1.0 / max(self._mobility(data, row), 1e-12)
        for i, dof in enumerate(self.plant.dofs):
            unit = np.zeros(self.model.nv)
            unit[dof] = 1.0
            self.pneumatics.joints[i]["effective_mass"] = 1.0 / max(self._mobility(data, unit), 1e-12)
            turning = self.model.jnt_type[self.model.dof_jntid[dof]] == mujoco.mjtJoint.mjJNT_HINGE
            self.pneumatics.joints[i]["turning"] = float(turning)

    def _mobility(self, data: mujoco.MjData, row: NDArray[np.float64]) -> float:
        solved = np.zeros((1, self.model.nv))
        mujoco.mj_solveM(self.model, data, solved, row[None, :])
        return float(row @ solved[0])

    def compute(self, data: mujoco.MjData) -> None:
        """Write the rod forces into `data.ctrl`, and the friction of joints into `data.qfrc_applied`."""
        self._check_data(data)
        mechanics = views.mechanics(self.model, data)
        if self.plant.turning[0]:
            freshen_levers(mechanics, self.plant)
        compute_forces(mechanics, self.plant)

    def advance(self, data: mujoco.MjData) -> None:
        """Bring the gas up to `data.time` under the `command` held since: call it after `mj_step1`, which freshens the lengths.

        Does nothing where the gas is there already.

        Raises:
            ModelError: `data` is of another model, a command is no number, the gas is too fast to be followed, or MuJoCo's clock is
                not one step further: the model's time step changed, or its state was reset and the plug-in was not.
        """
        self._check_data(data)
        self._check_time_step()
        self.plant.clock[views.STEPPED] = 0.0
        ahead = data.time - self.plant.clock[views.GAS_TIME]
        if abs(ahead) <= CLOCK_SLACK * self.dt:
            return
        if not abs(ahead - self.dt) <= CLOCK_SLACK * self.dt:
            self.plant.clock[views.MUJOCO_TIME] = data.time
            self.check(OUT_OF_STEP)
        self.check(advance_gas(views.mechanics(self.model, data), self.plant))
        self.plant.clock[views.GAS_TIME] = data.time

    def step(self, data: mujoco.MjData) -> None:
        """Bring the gas up to now, write the forces, and let MuJoCo take one step under them: one compiled call.

        After it `data` is one step ahead of the gas. Positions and pressures of one moment are read between `advance` and `mj_step2`.
        An error that MuJoCo itself calls fatal ends the process here; in the long form it is raised.

        Raises:
            ModelError: as `advance`, or `data` is of another model.
        """
        if data is not self._stepped:
            self._check_data(data)
            self._bound = Bound(views.mechanics(self.model, data), self.plant, self.model, data)
            self._stepped, self._places, self._take_step = data, self._bound.places, straight(take_step)
        became = self._take_step(*self._places)
        if became:
            self.check(became)

    def check(self, became: int) -> None:
        """Raise what is wrong where a step of the gas became anything but `FOLLOWED`.

        Raises:
            ModelError: as `advance`.
        """
        if became == OUT_OF_STEP:
            raise self._out_of_step()
        if became != FOLLOWED:
            plant = self.plant
            raise self.pneumatics.refused(became, plant.x, plant.x1, plant.command)

    def _out_of_step(self) -> ModelError:
        """Return what put MuJoCo's clock elsewhere than one step behind the gas's, and what to do."""
        now, gas = float(self.plant.clock[views.MUJOCO_TIME]), float(self.plant.clock[views.GAS_TIME])
        self._check_time_step()
        if not now >= gas:
            return ModelError(
                f"MuJoCo's clock went back from {gas:g} s to {now:g} s: call the plug-in's reset after mj_resetData, which MuJoCo calls "
                "itself where a position, speed or force is no number"
            )
        return ModelError(
            f"MuJoCo's clock is at {now:g} s and the gas at {gas:g} s: bring the gas up in every step of {self.dt:g} s, or call reset"
        )

    def snapshot(self, data: mujoco.MjData) -> Snapshot:
        """Return MuJoCo's state and the gas's together."""
        return Snapshot.of(self.model, data, self.pneumatics, self.plant)

    def restore(self, data: mujoco.MjData, snapshot: Snapshot) -> None:
        """Put both states back; what follows is what followed then, to the last bit."""
        snapshot.put_back(self.model, data, self.pneumatics, self.plant)
