"""What resists the motion of a piston or a joint: every mechanical effect, in the order in which it acts.

Dry friction is carried by a bristle: a spring that follows the motion until the dry level is reached and then slides with it. At
rest under less than the level it holds without creep, whatever the time step; where `presliding` is declared it is LuGre's.
"""

from __future__ import annotations

import math

from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects import (
    asymmetric_friction,
    coulomb_friction,
    presliding,
    pressure_dependent_friction,
    quadratic_drag,
    return_spring,
    stribeck_friction,
    viscous_friction,
)

#: How far a stuck piston (m) or joint (rad) gives before it slides where no presliding is declared.
STUCK_TRAVEL = 1e-5
STUCK_ANGLE = 1e-4

#: A stuck contact answers no faster than this [s], nor than two time steps; a declared presliding no faster than one.
STUCK_TIME = 2e-3


@kernel
def dry_level(c, v: float, z: float, gauge_1: float, gauge_2: float) -> float:
    """Return the dry friction that a piston moving at v, its contact bent by z, meets [N]."""
    level = coulomb_friction.level(c.coulomb_friction)
    level += asymmetric_friction.level(c.asymmetric_friction, z if z != 0.0 else v)
    level += pressure_dependent_friction.level(c.pressure_dependent_friction, gauge_1, gauge_2)
    level += stribeck_friction.excess(c.stribeck_friction, level, v)
    return level


@kernel
def joint_dry_level(j, v: float, z: float) -> float:
    """Return the dry friction that a joint moving at v, its contact bent by z, meets [N or N m]."""
    level = coulomb_friction.level(j.coulomb_friction)
    level += asymmetric_friction.level(j.asymmetric_friction, z if z != 0.0 else v)
    level += stribeck_friction.excess(j.stribeck_friction, level, v)
    return level


@kernel
def bristle_stiffness(c, level: float) -> float:
    """Return the stiffness of the stuck contact [N/m or N m/rad], never more than the time step resolves."""
    stiff, fastest = c.presliding.stiffness, c.step
    if stiff <= 0.0:
        stiff = level / (STUCK_ANGLE if c.turning > 0.0 else STUCK_TRAVEL)
        fastest = max(STUCK_TIME, 2.0 * c.step)
    if c.effective_mass > 0.0 and fastest > 0.0:
        stiff = min(stiff, c.effective_mass / (fastest * fastest))
    return stiff


@kernel
def move_bristle(c, z: float, v: float, level: float, h: float) -> float:
    """Return the bristle's deflection after `h` seconds at speed v [m or rad]."""
    if level <= 0.0:
        return 0.0
    stiffness = bristle_stiffness(c, level)
    if c.presliding.stiffness > 0.0:
        return presliding.bristle(stiffness, z, v, level, h)
    most = level / stiffness
    return min(max(z + v * h, -most), most)


@kernel
def dry_force(c, z: float, v: float, level: float) -> float:
    """Return the dry friction against the motion [N or N m], with the damping of a contact that sticks."""
    if level <= 0.0:
        return 0.0
    stiffness = bristle_stiffness(c, level)
    if c.presliding.stiffness > 0.0:
        damping = presliding.damping(c.presliding, v, c.turning)
        if c.effective_mass > 0.0 and c.step > 0.0:
            damping = min(damping, c.effective_mass / c.step)
        return stiffness * z + damping * (v - stiffness * abs(v) * z / level)
    force = stiffness * z
    if abs(force) < level:
        force += math.sqrt(stiffness * c.effective_mass) * v
    return min(max(force, -level), level)


@kernel
def steady_force(c, x: float, v: float) -> float:
    """Return what resists besides dry friction [N or N m]: viscous, quadratic, spring."""
    force = viscous_friction.force(c.viscous_friction, v)
    force += quadratic_drag.force(c.quadratic_drag, v)
    if c.effective_mass > 0.0 and c.step > 0.0:  # more than this would not slow the part within a step but throw it back
        most = 0.5 * c.effective_mass / c.step * abs(v)
        force = min(max(force, -most), most)
    force += return_spring.force(c.return_spring, x)
    return force


@kernel
def piston_resistance(c, z: float, x: float, v: float, gauge_1: float, gauge_2: float) -> float:
    """Return the force that a piston at x, moving at v, meets [N], against +v."""
    return dry_force(c, z, v, dry_level(c, v, z, gauge_1, gauge_2)) + steady_force(c, x, v)


@kernel
def joint_resistance(j, z: float, q: float, qd: float) -> float:
    """Return the generalised force that a joint meets [N or N m], against +qd."""
    return dry_force(j, z, qd, joint_dry_level(j, qd, z)) + steady_force(j, q, qd)
