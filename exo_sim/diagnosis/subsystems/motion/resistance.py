"""The force that resists a piston or joint along a measured motion."""

from __future__ import annotations

import math

import numpy as np

from exo_sim.physics.compiled import kernel
from exo_sim.physics.conditions import Motion
from exo_sim.physics.friction import bristle_stiffness, contact_damping, dry_force, dry_level, move_bristle, steady_force

#: Of the Gaussian of the filter, to either side of its centre; and of centres behind the start, a quarter of its standard deviation apart.
NODES, CENTRES = 8, 8


@kernel
def resistance_along(c, time, x, v, gauge, out):
    """Write the force that resists a piston moved along a measured path [N], against +v.

    Args:
        c: Record CYLINDER.
        time, x, v: Motion, shape (n,).
        gauge: Pressures above the atmosphere, shape (n, 2).
        out: Result, shape (n,).
    """
    z, earlier, damping = 0.0, 0.0, 0.0
    for i in range(time.size):
        before, motion = z, Motion(x[i], v[i], z, gauge[i, 0], gauge[i, 1])
        level = dry_level(c, motion)
        if i > 0:
            z = move_bristle(c, before, 0.5 * (v[i] + v[i - 1]), level, time[i] - time[i - 1])
            motion = Motion(x[i], v[i], z, gauge[i, 0], gauge[i, 1])
            if (z > 0.0) != (before > 0.0) or (z < 0.0) != (before < 0.0):  # of a bent contact only the sign counts for the level
                level = dry_level(c, motion)
        out[i] = steady_force(c, motion)
        if c.presliding.damping > 0.0 and level > 0.0:
            out[i] += bristle_stiffness(c, level) * z
            if i > 0:  # by how much bristles moved on, however few samples they took for it
                out[i - 1] += damping * (z - earlier) / (time[i] - time[max(i - 2, 0)])
            earlier, damping = before, contact_damping(c, v[i])
        else:
            out[i] += dry_force(c, z, v[i], level)
            damping = 0.0


@kernel
def resistance_starting(c, x, gauge, slowest, acceleration, fastest, rate, width, damping, out):
    """Write the peak of what resists a contact that breaks loose behind a Gaussian filter [N], against +v, beside a damping.

    Before it breaks loose it holds what drives it, which rises at a rate; then it slides ever faster.

    Args:
        c: Record CYLINDER.
        x: Where, shape (k,).
        gauge: Pressures above the atmosphere, shape (k, 2).
        slowest: Speed at which it has broken loose, with the sign of the motion, shape (k,).
        acceleration: How fast its speed rises [m/s^2], shape (k,).
        fastest: The speed at which that ends [m/s], shape (k,).
        rate: How fast what drives it rises before [N/s], shape (k,).
        width: Standard deviation of the filter [s].
        damping: A force in proportion to speed that does not count [N s/m].
        out: Result, shape (k,).
    """
    nodes = 2 * NODES + 1
    for i in range(x.size):
        way = 1.0 if slowest[i] > 0.0 else -1.0
        least, peak = abs(slowest[i]), -np.inf
        for k in range(CENTRES):
            centre, total, weights = 0.25 * k * width, 0.0, 0.0
            for j in range(nodes):
                from_centre = 3.0 * (j - NODES) / NODES
                at = centre + from_centre * width
                speed = min(max(acceleration[i] * at, least), fastest[i])
                motion = Motion(x[i], way * speed, 0.0, gauge[i, 0], gauge[i, 1])
                resists = dry_level(c, motion) + way * steady_force(c, motion) - damping * speed
                weight = math.exp(-0.5 * from_centre * from_centre)
                weights += weight
                total += weight * (resists + min(rate[i] * at, 0.0))
            peak = max(peak, total / weights)
        out[i] = way * peak
