"""MuJoCo's state and the gas's, taken together and put back together."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.pneumatics import Pneumatics
from exo_sim.simulation import views
from exo_sim.simulation.views import Plant

_CONTACT = ["effective_mass", "turning"]
_CONTACT_OF_CYLINDER = [*_CONTACT, "arm"]
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


@dataclass(frozen=True)
class Snapshot:
    """The state of a machine between two steps.

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

    @classmethod
    def of(cls, model: mujoco.MjModel, data: mujoco.MjData, gas: Pneumatics, plant: Plant) -> Snapshot:
        """Return that of a plug-in's arrays and MuJoCo's data, copied."""
        physics = np.zeros(mujoco.mj_stateSize(model, _STATE))
        mujoco.mj_getState(model, data, physics, _STATE)
        return cls(
            physics, gas.vector.copy(), gas.history.copy(), plant.x.copy(), np.concatenate([plant.q, plant.felt]), gas.start.copy(),
            (gas.cylinders[_CONTACT_OF_CYLINDER].copy(), gas.joints[_CONTACT].copy()),
            float(plant.clock[views.GAS_TIME]),
        )

    def put_back(self, model: mujoco.MjModel, data: mujoco.MjData, gas: Pneumatics, plant: Plant) -> None:
        """Write it into the same arrays and data that it is of, or into those of another plug-in on the same model."""
        mujoco.mj_setState(model, data, self.physics, _STATE)
        gas.vector[:], gas.history[:], gas.start[:] = self.gas, self.history, self.start
        for name in _CONTACT_OF_CYLINDER:
            gas.cylinders[name] = self.contacts[0][name]
        for name in _CONTACT:
            gas.joints[name] = self.contacts[1][name]
        plant.x[:] = self.lengths
        plant.clock[[views.GAS_TIME, views.STEPPED]] = self.time, 0.0
        joints = len(plant.q)
        plant.q[:], plant.felt[:] = self.positions[:joints], self.positions[joints:]
        mujoco.mj_forward(model, data)
