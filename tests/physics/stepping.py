"""How the tests move a plant along: pistons held, driven along a path, or free with a mass."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world


def tank(volume: float, valve_area: float, dt: float, **world: float) -> Pneumatics:
    """Return two chambers of one volume on one valve, the piston at its end and held."""
    record = paper_world()
    for name, value in world.items():
        record[name] = value
    cylinder = paper_cylinder(0.01, 0.0, 1e-6, valve_area, volume, volume)
    cylinder["dead_volume_2"] -= 1e-6 * cylinder["area_2"]
    return Pneumatics(record, cylinder, dt=dt)


def bench(dt: float = 1e-3, p_1: float = 5e5, p_2: float = 565237.727273, x: float = 0.05, dead: float = 0.0) -> Pneumatics:
    """Return a 32/12 x 100 mm cylinder, not yet filled unless pressures balance at mid-stroke (A.4.10)."""
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.1, 5e-6, dead, dead), dt=dt)
    gas.fill(np.array([x]), p_1, p_2)
    return gas


def hold(gas: Pneumatics, command: float, seconds: float, x: float = 0.0) -> None:
    """Keep the pistons at x under a command."""
    at, held = np.full(len(gas.cylinders), x), np.full(len(gas.cylinders), command)
    for _ in range(round(seconds / gas.dt)):
        gas.advance(at, at, held)


def drive(gas: Pneumatics, path: NDArray[np.float64], command: float = 0.0) -> NDArray[np.float64]:
    """Move one piston along `path` (n,), a step an entry; return time-ordered (p_1, p_2, t_1, t_2, force), shape (n, 5)."""
    held, out = np.array([command]), np.empty((len(path), 5))
    for i, x in enumerate(path):
        now = path[i : i + 1]
        if i:
            gas.advance(path[i - 1 : i], now, held)
        v = np.array([(x - path[i - 1]) / gas.dt if i else 0.0])
        out[i] = (*gas.pressures(now)[0], *gas.temperatures()[0], gas.forces(now, v)[0])
    return out


def free(
    gas: Pneumatics, mass: float, x: float, v: float, steps: int, command: float | NDArray[np.float64] = 0.0, load: float = 0.0
) -> NDArray[np.float64]:
    """Let one piston push a mass (kick, drift, kick); return (x, v, p_1, p_2) after every step, shape (steps + 1, 4)."""
    commands = np.broadcast_to(command, (steps,))
    at, speed = np.array([x]), np.array([v])
    push = (gas.forces(at, speed)[0] + load) / mass
    out = np.empty((steps + 1, 4))
    out[0] = x, v, *gas.pressures(at)[0]
    for i in range(steps):
        half = speed + 0.5 * gas.dt * push
        new = at + gas.dt * half
        gas.advance(at, new, commands[i : i + 1])
        at = new
        push = (gas.forces(at, half)[0] + load) / mass
        speed = half + 0.5 * gas.dt * push
        out[i + 1] = at[0], speed[0], *gas.pressures(at)[0]
    return out
