"""Chambers into which something lets gas that no recorded command speaks of: pressure regulators, or a valve whose command was not logged.

The pressure of a closed chamber follows its volume, between an isothermal and an isentropic change; a leak to the outside lowers it, and
one past the piston raises it only while the other chamber's is higher. What rises beyond that was fed, but for gas that expanded before
and warms up, which is little beside the changes that made it cold.
"""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.conventions.machine import Machine
from exo_sim.machine.linkage import linkages
from exo_sim.recording.noise import white_noise
from exo_sim.recording.table import Recording
from exo_sim.rig import Cylinder, Rig

Array = NDArray[np.float64]

#: Time over which changes are looked at [s].
SPAN = 0.2
#: A rise is one beyond so many standard deviations of the noise.
CLEAR = 5.0
#: Share of the squares of all changes that rises of fed chambers make up at least. Three benches whose command was taken away have 0.44 to
#: 2.6, regulators that swing both pressures 0.5 to 0.6; 150 closed cylinders with walls of 0.03 to 10 s, drawn by chance, 0.006 at most.
LEAST_SHARE = 0.1
#: A vessel is filled once or twice before it is left alone; so many fillings are a drive.
FILLINGS = 3


def fed_cylinders(recording: Recording, rig: Rig, model: mujoco.MjModel) -> frozenset[str]:
    """Return the cylinders that were fed, as the pressures of all their chambers say, and of which no valve command was recorded.

    Args:
        recording: Signals in SI.
        rig, model: The machine.
    """
    unknown = {name for name, c in rig.cylinders.items() if not any(f"{name}.{command}" in recording for command in c.commands)}
    if not unknown:
        return frozenset()
    machine, found = Machine(rig, model, linkages(rig, model)), set()
    for link in (link for link in machine.links if link.cylinder in unknown):
        cylinder = machine.cylinder(link)
        position = recording.get(f"{link.joint}.position")
        sides = (1,) if cylinder.single_acting else (1, 2)
        measured = [one for side in sides if (one := recording.get(f"{cylinder.name}.pressure_{side}")) is not None]
        if position is None or len(measured) < len(sides):
            continue
        other = measured[1:] or [np.full(len(position), rig.environment.pressure)]
        pressure, volume = np.array([measured[0], *other]), volumes(cylinder, machine.piston(link, position))
        if is_fed(recording.time, pressure, volume, rig.heat_capacity_ratio):
            found.add(cylinder.name)
    return frozenset(found)


def volumes(cylinder: Cylinder, piston: Array) -> Array:
    """Return the volumes of both chambers [m^3], shape (2, n), with the piston at X [m], shape (n,)."""
    travel = np.clip(piston, 0.0, cylinder.stroke)
    ahead, behind = cylinder.area_1 * travel, cylinder.area_2 * (cylinder.stroke - travel)
    return np.array([cylinder.dead_volume_1 + ahead, cylinder.dead_volume_2 + behind])


def is_fed(time: Array, pressure: Array, volume: Array, k: float) -> bool:
    """Return whether gas entered a chamber from outside the cylinder, again and again.

    Args:
        time: [s], shape (n,).
        pressure, volume: Of both chambers [Pa], [m^3], shape (2, n); NaN where a sample is missing.
        k: Ratio of heat capacities.
    """
    grid = np.arange(time[0], time[-1], SPAN)
    if len(grid) < 2 * FILLINGS:
        return False
    there = np.isfinite(pressure).all(axis=0) & np.isfinite(volume).all(axis=0) & (pressure > 0.0).all(axis=0)
    if there.sum() < len(grid):
        return False
    p, v = (np.array([np.interp(grid, time[there], one[there]) for one in both]) for both in (pressure, volume))
    seen = np.interp(grid, time, there) > 0.0
    covered = seen[1:] & seen[:-1]
    for side in range(2):
        change, shrunk = np.diff(np.log(p[side])), -np.diff(np.log(v[side]))
        rise = change - np.maximum(shrunk, k * shrunk)
        above = p[side] >= p[1 - side]
        asked = above[1:] & above[:-1] & covered
        noise = np.sqrt(2.0) * white_noise(pressure[side]) / p[side]
        clear = (rise > CLEAR * np.maximum(noise[1:], noise[:-1])) & asked
        begun = int(np.sum(np.diff(clear.astype(int), prepend=0) == 1))
        if begun >= FILLINGS and np.sum(rise[clear] ** 2) >= LEAST_SHARE * np.sum(change[asked] ** 2):
            return True
    return False
