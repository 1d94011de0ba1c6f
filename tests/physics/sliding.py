"""A mass that slides on a joint with friction of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.conditions import Motion
from exo_sim.physics.forces import joint_forces
from exo_sim.physics.friction import joint_dry_level, joint_resistance, move_bristle
from exo_sim.physics.plant_records import JOINT

LUGRE = {
    "coulomb_friction": {"force": 15.0},
    "stribeck_friction": {"breakaway": 25.0, "velocity": 0.02},
    "viscous_friction": {"coefficient": 40.0},
}
LUGRE_TABLE = ((1e-4, 25.003750003), (1e-3, 25.015031224), (0.01, 23.188007831), (0.05, 17.019304541), (0.2, 23.0))


def slide(
    joint: NDArray[np.void], mass: float, v: float, load: Callable[[float, float], float], seconds: float, dt: float, q: float = 0.0
) -> NDArray[np.float64]:
    """Move a mass on a joint with friction of its own under load(t, q) [N]; return (q, v) after every step, shape (n + 1, 2)."""
    joint["effective_mass"], joint["step"] = mass, dt
    bristle, force = np.zeros(1), np.zeros(1)
    out = [(q, v)]
    for i in range(round(seconds / dt)):
        joint_forces(joint, bristle, np.array([q]), np.array([v]), force)
        v += dt * (force[0] + load(i * dt, q)) / mass
        level = joint_dry_level(joint[0], Motion(q, v, bristle[0], 0.0, 0.0))
        bristle[0] = move_bristle(joint[0], bristle[0], v, level, dt)
        q += dt * v
        out.append((q, v))
    return np.array(out)


def contact(**effects: Mapping[str, float]) -> NDArray[np.void]:
    """Return one joint with these effects on."""
    joint = np.zeros(1, JOINT)
    for name, numbers in effects.items():
        for key, value in numbers.items():
            joint[name][key] = value
    return joint


def constant(force: float) -> Callable[[float, float], float]:
    return lambda t, q: force


def nothing(t: float, q: float) -> float:
    """No load."""
    return 0.0


def steady_resistance(joint: NDArray[np.void], v: float) -> float:
    """Return what a joint meets after sliding at v for long [N]."""
    j, z = joint[0], 0.0
    level = joint_dry_level(j, Motion(0.0, v, z, 0.0, 0.0))
    for _ in range(200):
        z = move_bristle(j, z, v, level, 1e-3 / abs(v) * 1e-1)
    return joint_resistance(j, Motion(0.0, v, z, 0.0, 0.0))
