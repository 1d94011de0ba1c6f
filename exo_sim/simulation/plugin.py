"""The pneumatics as a plug-in of MuJoCo: `reset`, `compute`, `advance` over `mjModel` and `mjData`."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ModelError, nearest
from exo_sim.machine.linkage import linkages, moment_row
from exo_sim.physics.pneumatics import Books
from exo_sim.rig import Rig, assembly
from exo_sim.simulation.bound_arrays import BoundArrays, straight, take_step
from exo_sim.simulation.coupling import advance_gas, compute_forces

_CONTACT = ["effective_mass", "turning"]
_CONTACT_OF_CYLINDER = [*_CONTACT, "arm"]


@dataclass(frozen=True)
class Snapshot:
    """MuJoCo's state and the gas's, taken together.

    Attributes:
        physics: MuJoCo's `mjSTATE_INTEGRATION`.
        gas: The pneumatic state vector.
        history: Commands still under way to their valves.
        lengths, positions: Where the pistons and joints were, and what the joints' friction exerted.
        start: The gas at the start of the books.
        contacts: What mass each dry contact holds, and the moment arms.
        time: How far the gas has come [s].
    """

    physics: NDArray[np.float64]
    gas: NDArray[np.float64]
    history: NDArray[np.float64]
    lengths: NDArray[np.float64]
    positions: NDArray[np.float64]
    start: NDArray[np.float64]
    contacts: tuple[NDArray[np.void], NDArray[np.void]]
    time: float


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
        ModelError: the model lacks an actuator or joint of the rig.
    """

    def __init__(self, model: mujoco.MjModel, rig: Rig):
        self.model, self.rig = model, rig
        self.links = linkages(rig, model)
        names = assembly.joints_with_effects(rig)
        known = [model.joint(i).name for i in range(model.njnt)]
        for name in names:
            if name not in known:
                raise ModelError(f'{rig.path}: effects act on joint "{name}", which {rig.model.name} lacks{nearest(name, known)}')
        self.joint_names = names
        self.dt = float(model.opt.timestep)
        drives = {link.cylinder: link.joint for link in self.links}
        self.pneumatics = assembly.pneumatics(rig, self.dt, names, drives)
        self._command = np.zeros(len(self.links))
        n, m = len(self.links), len(names)
        self._actuators = np.array([link.actuator for link in self.links], dtype=np.int64)
        self._retracted = np.array([rig.cylinders[link.cylinder].retracted_length for link in self.links])
        ids = [model.joint(name).id for name in names]
        self._addresses = np.array([model.jnt_qposadr[i] for i in ids], dtype=np.int64)
        self._dofs = np.array([model.jnt_dofadr[i] for i in ids], dtype=np.int64)
        self._x, self._x1, self._v, self._force = np.zeros((4, n))
        self._q, self._q1, self._qd, self._own, self._felt = np.zeros((5, m))
        self._driven = np.array([link.dof for link in self.links], dtype=np.int64)
        self._clock = np.zeros(2)  # how far the gas has come; what MuJoCo's clock said last
        self._turning = any(effect.turning for effect in rig.effects)
        self._bound: BoundArrays | None = None
        self._stepped: mujoco.MjData | None = None  # what `step` was last called with, and the call for it
        self._place, self._take_step = 0, take_step

    def __getstate__(self) -> dict[str, object]:
        return {**self.__dict__, "_bound": None, "_stepped": None, "_take_step": None}  # a copy's arrays are elsewhere

    def refit(self, rig: Rig) -> None:
        """Take the numbers of another rig: the same cylinders on the same actuators, with other sizes, supply or effects' values.

        The arrays stay where they are. Call `reset` next; attachment points are the model's (`machine.attachment.attach`).
        """
        drives = {link.cylinder: link.joint for link in self.links}
        other = assembly.pneumatics(rig, self.dt, self.joint_names, drives)
        self.rig = rig
        self.pneumatics.world[:], self.pneumatics.cylinders[:] = other.world, other.cylinders
        self.pneumatics.joints[:] = other.joints
        self._retracted[:] = [rig.cylinders[link.cylinder].retracted_length for link in self.links]

    @property
    def command(self) -> NDArray[np.float64]:
        """Valve commands, -1 to 1, one a cylinder in the rig's order, shape (n,). Set it before `advance`."""
        return self._command

    @command.setter
    def command(self, value: NDArray[np.float64]) -> None:
        self._command[:] = value

    @property
    def force(self) -> NDArray[np.float64]:
        """Rod forces of the last `compute`, shape (n,) [N]; + pushes out."""
        return self._force

    @property
    def lengths(self) -> NDArray[np.float64]:
        """Piston positions X as the joints have them, shape (n,) [m]."""
        return self._x

    def pressures(self) -> NDArray[np.float64]:
        """Return both chamber pressures of each cylinder, shape (n, 2) [Pa]."""
        return self.pneumatics.pressures(self._x)

    def books(self) -> Books:
        """Return what passed through since `reset`, and what the books cannot account for."""
        return self.pneumatics.books()

    def reset(
        self,
        data: mujoco.MjData,
        pressure_1: NDArray[np.float64] | float | None = None,
        pressure_2: NDArray[np.float64] | float | None = None,
    ) -> None:
        """Fill the chambers with gas at rest, at the atmosphere unless pressures [Pa] are given, for the positions in `data`."""
        mujoco.mj_forward(self.model, data)
        self._x[:] = data.actuator_length[self._actuators] - self._retracted
        self._q[:] = data.qpos[self._addresses]
        self._felt[:] = 0.0
        self.command[:] = 0.0
        atmosphere = self.rig.environment.pressure
        p_1 = atmosphere if pressure_1 is None else pressure_1
        p_2 = atmosphere if pressure_2 is None else pressure_2
        self._masses(data)
        self.pneumatics.fill(self._x, p_1, p_2)
        self.pneumatics.settle_transmission(self._x)
        self._clock[0] = data.time

    def _masses(self, data: mujoco.MjData) -> None:
        """Tell each dry contact what mass it holds: the inverse of J M^-1 J'."""
        for i, link in enumerate(self.links):
            row = moment_row(self.model, data, link.actuator)
            self.pneumatics.cylinders[i]["arm"] = row[link.dof]
            self.pneumatics.cylinders[i]["effective_mass"] = 1.0 / max(self._mobility(data, row), 1e-12)
        for i, dof in enumerate(self._dofs):
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
        if self._turning:
            for i, link in enumerate(self.links):
                self.pneumatics.cylinders[i]["arm"] = moment_row(self.model, data, link.actuator)[link.dof]
        gas = self.pneumatics
        compute_forces(
            gas.world[0], gas.cylinders, gas.joints, gas.vector, self._actuators, self._retracted,
            data.actuator_length, data.actuator_velocity, self._dofs, self._addresses, data.qpos, data.qvel,
            data.ctrl, data.qfrc_applied, self._x, self._v, self._force, self._q, self._qd, self._own, self._felt,
        )  # fmt: skip

    def advance(self, data: mujoco.MjData) -> None:
        """Bring the gas up to `data.time` under the `command` held since: call it after `mj_step1`, which freshens the lengths.

        Does nothing where the gas is there already.
        """
        if data.time <= self._clock[0] + 0.5 * self.dt:
            return
        gas = self.pneumatics
        advance_gas(
            gas.world[0], gas.cylinders, gas.joints, gas.vector, gas.history, self._actuators, self._retracted,
            data.actuator_length, self._addresses, data.qpos, self.command, self.dt,
            self._x, self._x1, self._q, self._q1, gas._work, gas._scratch,
        )  # fmt: skip
        self._clock[0] = data.time

    def step(self, data: mujoco.MjData) -> None:
        """Bring the gas up to now, write the forces, and let MuJoCo take one step under them: one compiled call.

        An error that MuJoCo itself calls fatal ends the process here; in the long form it is raised.
        """
        if data is not self._stepped:
            self._bound = BoundArrays(self, data)
            self._stepped, self._place, self._take_step = data, self._bound.place, straight(take_step)
        self._take_step(self._place)

    def snapshot(self, data: mujoco.MjData) -> Snapshot:
        """Return MuJoCo's state and the gas's together."""
        kind = mujoco.mjtState.mjSTATE_INTEGRATION
        physics = np.zeros(mujoco.mj_stateSize(self.model, kind))
        mujoco.mj_getState(self.model, data, physics, kind)
        gas = self.pneumatics
        return Snapshot(
            physics, gas.vector.copy(), gas.history.copy(), self._x.copy(), np.concatenate([self._q, self._felt]), gas._start.copy(),
            (gas.cylinders[_CONTACT_OF_CYLINDER].copy(), gas.joints[_CONTACT].copy()),
            float(self._clock[0]),
        )

    def restore(self, data: mujoco.MjData, snapshot: Snapshot) -> None:
        """Put both states back; what follows is what followed then, to the last bit."""
        mujoco.mj_setState(self.model, data, snapshot.physics, mujoco.mjtState.mjSTATE_INTEGRATION)
        gas = self.pneumatics
        gas.vector[:], gas.history[:], gas._start[:] = snapshot.gas, snapshot.history, snapshot.start
        for name in _CONTACT_OF_CYLINDER:
            gas.cylinders[name] = snapshot.contacts[0][name]
        for name in _CONTACT:
            gas.joints[name] = snapshot.contacts[1][name]
        self._x[:] = snapshot.lengths
        self._clock[0] = snapshot.time
        m = len(self.joint_names)
        self._q[:], self._felt[:] = snapshot.positions[:m], snapshot.positions[m:]
        mujoco.mj_forward(self.model, data)
