"""What torque a worn machine's cylinders and ankle motors can hold along a motion, and where that is too little."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.control import machine_dynamics
from exo_sim.control.valve_control import largest_forces
from exo_sim.gait.motion import Motion
from exo_sim.machine.linkage import Linkage, moment_row
from exo_sim.simulation.plugin import PneumaticPlugin

Array = NDArray[np.float64]


def torque_limits(plugin: PneumaticPlugin, motion: Motion) -> Array:
    """Return least and largest torque that cylinders and ankle motors can hold along the cycle [N m], (n, 6, 2), n phases.

    Args:
        plugin: The cylinders on their model.
        motion: The wearer's.
    """
    rig, model, cylinders = plugin.rig, plugin.model, plugin.pneumatics.cylinders
    data = mujoco.MjData(model)
    supply, atmosphere = rig.supply.pressure, rig.environment.pressure
    forces = largest_forces(cylinders["area_1"], cylinders["area_2"], supply, atmosphere, atmosphere)
    places = motion.position[machine_dynamics.PICK]
    out = np.zeros((len(places), 6, 2))
    if rig.ankle.mode == "powered":
        motors = [at for at in (2, 5) if at + 3 not in {link.dof for link in plugin.links}]
        out[:, motors] = [-rig.ankle.torque, rig.ankle.torque]
    for i, position in enumerate(places):
        data.qpos[:] = position
        mujoco.mj_forward(model, data)
        for link, force in zip(plugin.links, forces):
            out[i, link.dof - 3] += np.sort(moment_row(model, data, link.actuator)[link.dof] * force)
    return out


def too_weak(links: Sequence[Linkage], payload: float, needed: Array, limits: Array) -> tuple[str, ...]:
    """Return a sentence on the cylinders that cannot hold what carrying the payload needs, if any.

    Args:
        links: The cylinders.
        payload: On the back [kg].
        needed: Joint torques [N m], shape (n, 6).
        limits: As `torque_limits` returns them.
    """
    short = []
    for link in links:
        torque, (low, high) = needed[:, link.dof - 3], limits[:, link.dof - 3].T
        worst = int(np.argmax(np.maximum(torque - high, low - torque)))
        if not low[worst] <= torque[worst] <= high[worst]:
            most = high[worst] if torque[worst] > 0.0 else low[worst]
            short.append(f"{link.cylinder} holds {most:.0f} of {torque[worst]:.0f} N m")
    if not short:
        return ()
    return (
        f"{payload:g} kg is more than the cylinders carry: {', '.join(short)}; the wearer bears the rest "
        "(more supply pressure, bore or moment arm, or less payload)",
    )
