"""Dry friction of the true machine: LuGre, its bristle advanced implicitly."""

from __future__ import annotations

import math

from exo_sim.trials.truth.compiled import kernel
from exo_sim.trials.truth.state import M1, M2, T1, T2, VP, XP


@kernel
def friction_level(v, p1, p2, rest, p):
    """Return the steady dry friction [N] at this velocity, chamber pressures and time at rest."""
    level = p.coulomb + p.dry_friction + p.pressure_friction * (p1 + p2 - 2.0 * p.ambient_pressure)
    level += p.forward if v >= 0.0 else p.backward
    static = level
    if p.stribeck_breakaway > level:
        static = p.stribeck_breakaway
    if p.dwell_growth > 0.0:
        static += p.dwell_growth * math.log10(1.0 + rest / 0.1)
    speed = p.stribeck_velocity if p.stribeck_velocity > 0.0 else 5e-3
    return level + (static - level) * math.exp(-((v / speed) ** 2))


@kernel
def dry_friction(y, bristle, dt, p):
    """Advance the bristles for one step; return their force [N]."""
    v = y[VP]
    p1 = y[M1] * p.gas_constant * y[T1] / (p.dead_1 + p.area_1 * y[XP])
    p2 = y[M2] * p.gas_constant * y[T2] / (p.dead_2 + p.area_2 * (p.stroke - y[XP]))
    bristle[1] = bristle[1] + dt if abs(v) < 1e-3 else 0.0
    level = friction_level(v, p1, p2, bristle[1], p)
    if p.bump_force > 0.0:
        level += p.bump_force * math.exp(-(((y[XP] - p.bump_place) / p.bump_width) ** 2))
    if level <= 1e-9:
        return 0.0
    z = (bristle[0] + v * dt) / (1.0 + abs(v) * dt * p.bristle_stiffness / level)
    damping = p.bristle_damping * math.exp(-((v / 0.02) ** 2))
    force = p.bristle_stiffness * z + damping * (z - bristle[0]) / dt
    bristle[0] = z
    return force
