"""The force that resists a piston or joint along a measured motion."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.conditions import Motion
from exo_sim.physics.friction import dry_level, move_bristle, piston_resistance


@kernel
def resistance_along(c, time, x, v, gauge, out):
    """Write the force that resists a piston moved along a measured path [N], against +v.

    Args:
        c: Record CYLINDER.
        time, x, v: Motion, shape (n,).
        gauge: Pressures above the atmosphere, shape (n, 2).
        out: Result, shape (n,).
    """
    z = 0.0
    for i in range(time.size):
        level = dry_level(c, Motion(x[i], v[i], z, gauge[i, 0], gauge[i, 1]))
        if i > 0:
            z = move_bristle(c, z, 0.5 * (v[i] + v[i - 1]), level, time[i] - time[i - 1])
        out[i] = piston_resistance(c, Motion(x[i], v[i], z, gauge[i, 0], gauge[i, 1]))
