"""What a cylinder with its valve can do: held still, and at the speed of its joint, where the valve's flow takes its share.

A piston moving evenly with the valve fully open settles at pressures for which the flow through each path (equations 30 and 31,
choked or not) makes up for the chamber's growth. An adiabatic chamber that grows at constant pressure takes the temperature of
what fills it; one that shrinks keeps its own, taken as the ambient. Back-pressure in the emptying chamber is so part of the answer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.compiled import kernel
from exo_sim.physics.conditions import Motion
from exo_sim.physics.friction import dry_level, steady_force
from exo_sim.physics.nozzle import flow

Array = NDArray[np.float64]
_BISECTIONS = 22


@kernel
def steady_pressure(growth, valve_area, p_node, t_node, t_gas, most, k, r):
    """Return the pressure at which a path's flow makes up for a chamber's growth [Pa], at most `most`.

    Args:
        growth: Of the chamber [m^3/s]; negative where it shrinks.
        valve_area: Of the open path [m^2].
        p_node, t_node: On the other side of the path.
        t_gas: Of the chamber's own gas, when it flows out.
        most: Largest pressure that counts: a chamber that shrinks faster than a choked path can empty it has no steady one.
        k, r: The gas.
    """
    low, high = 1.0, most
    for _ in range(_BISECTIONS):
        p = 0.5 * (low + high)
        into = flow(valve_area, p_node, t_node, p, t_gas, k, r)
        temperature = t_node if into >= 0.0 else t_gas
        if into * r * temperature > p * growth:
            low = p
        else:
            high = p
    return 0.5 * (low + high)


@kernel
def driving_force(world, c, x, v, opening):
    """Return the rod force with the valve fully open one way [N], friction of the rig's effects taken off.

    Args:
        world, c: Records of the plant.
        x, v: Piston position [m] and speed [m/s]; v = 0 gives the static force.
        opening: +1 pushes, -1 pulls.
    """
    p_s, t_s, p_e, t_e = world.supply_pressure, world.supply_temperature, world.exhaust_pressure, world.ambient
    most = 4.0 * p_s
    if c.single_acting > 0.0:
        node, t = (p_s, t_s) if opening > 0.0 else (p_e, t_e)
        p_1 = node if v == 0.0 else steady_pressure(c.area_1 * v, c.valve_area, node, t, t_e, most, world.k, world.r)
        p_2 = world.atmosphere
    else:
        if opening > 0.0:
            n_1, t_1, n_2, t_2 = p_s, t_s, p_e, t_e
        else:
            n_1, t_1, n_2, t_2 = p_e, t_e, p_s, t_s
        p_1 = n_1
        p_2 = n_2
        if v != 0.0:
            p_1 = steady_pressure(c.area_1 * v, c.valve_area, n_1, t_1, t_e, most, world.k, world.r)
            p_2 = steady_pressure(-c.area_2 * v, c.valve_area, n_2, t_2, t_e, most, world.k, world.r)
    force = p_1 * c.area_1 - p_2 * c.area_2 - world.atmosphere * (c.area_1 - c.area_2)
    motion = Motion(x, v, 0.0, p_1 - world.atmosphere, p_2 - world.atmosphere)
    level = dry_level(c, motion)
    way = opening if v == 0.0 else (1.0 if v > 0.0 else -1.0)  # at rest friction is against the way it is about to go
    return force - way * level - steady_force(c, motion)


@kernel
def force_bounds(world, c, x, v, low, high):
    """Write least and largest rod force at each point, shape (n,) each [N]."""
    for i in range(x.size):
        low[i] = driving_force(world, c, x[i], v[i], -1.0)
        high[i] = driving_force(world, c, x[i], v[i], 1.0)


@dataclass(frozen=True)
class Capability:
    """What a joint's cylinder can do along a motion, shape (n,) each.

    Attributes:
        arm: Moment arm [m].
        length: Between the pivots [m].
        still: Least and largest static torque [N m].
        moving: The same at the joint's speed.
    """

    arm: Array
    length: Array
    still: tuple[Array, Array]
    moving: tuple[Array, Array]

    def slack(self, torque: Array) -> Array:
        """Return how far a torque stays inside the capability at speed [N m], negative outside, shape (n,)."""
        return np.minimum(self.moving[1] - torque, torque - self.moving[0])

    def still_slack(self, torque: Array) -> Array:
        """Return how far it stays inside the static capability [N m], shape (n,)."""
        return np.minimum(self.still[1] - torque, torque - self.still[0])


def capability(world: np.void, record: np.void, arm: Array, length: Array, retracted: float, speed: Array) -> Capability:
    """Return what a cylinder can do.

    Args:
        world: Record of gas, supply and atmosphere.
        record: The cylinder's record, effects included.
        arm, length: Of its linkage along the motion, shape (n,).
        retracted: Length at X = 0 [m].
        speed: Of the joint [rad/s], shape (n,).
    """
    x = length - retracted
    bounds = []
    for v in (np.zeros_like(x), arm * speed):
        low, high = np.empty_like(x), np.empty_like(x)
        force_bounds(world, record, x, v, low, high)
        bounds.append((np.minimum(arm * low, arm * high), np.maximum(arm * low, arm * high)))
    return Capability(arm, length, bounds[0], bounds[1])


def margin(slack: Array, torque: Array) -> float:
    """Return the least slack as a share of the largest torque wanted: 0 just suffices, 0.25 keeps a quarter of the peak."""
    return float(slack.min() / max(float(np.abs(torque).max()), 1e-9))
