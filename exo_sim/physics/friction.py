"""What resists the motion of a piston or a joint: every mechanical effect, in the order in which it acts.

Dry friction is carried by a bristle: a spring that follows the motion until the dry level is reached and then slides with it. At
rest under less than the level it holds without creep, whatever the time step; where `presliding` is declared it is LuGre's.
"""

from __future__ import annotations

import math

from exo_sim.physics.compiled import inlined_kernel, kernel
from exo_sim.physics.effects import friction_smoothing, presliding
from exo_sim.physics.summed_effects import (
    joint_damping,
    joint_dry_friction,
    joint_spring_force,
    joint_with_excess,
    piston_damping,
    piston_dry_friction,
    piston_spring_force,
    piston_with_excess,
)

#: How far a stuck piston (m) or joint (rad) gives before it slides where no presliding is declared.
STUCK_TRAVEL = 1e-5
STUCK_ANGLE = 1e-4

#: A stuck contact answers no faster than this [s], nor than two time steps; a declared presliding no faster than one.
STUCK_TIME = 2e-3


@inlined_kernel
def sharp_level(c, motion):
    """Return the dry friction that a piston in this `Motion` meets [N], as if nothing smoothed it."""
    return piston_with_excess(c, piston_dry_friction(c, motion), motion)


@kernel
def dry_level(c, motion):
    """Return the dry friction that a piston in this `Motion` meets [N]."""
    return friction_smoothing.smoothed(c.friction_smoothing, sharp_level(c, motion), motion.v)


@kernel
def joint_dry_level(j, motion):
    """Return the dry friction that a joint in this `Motion` meets [N or N m]."""
    level = joint_with_excess(j, joint_dry_friction(j, motion), motion)
    return friction_smoothing.smoothed(j.friction_smoothing, level, motion.v)


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
        return stiffness * z + contact_damping(c, v) * (v - stiffness * abs(v) * z / level)
    force = stiffness * z
    if abs(force) < level:
        force += math.sqrt(stiffness * c.effective_mass) * v
    return min(max(force, -level), level)


@kernel
def contact_damping(c, v: float) -> float:
    """Return the damping of the bristles of a declared presliding [N s/m or N m s/rad], never more than the time step resolves."""
    damping = presliding.damping(c.presliding, v, c.turning)
    if c.effective_mass > 0.0 and c.step > 0.0:
        damping = min(damping, c.effective_mass / c.step)
    return damping


@kernel
def _damped(part, v: float, damping: float) -> float:
    """Return the force of a damping at speed v: more than this would not slow the part within a step but throw it back [N or N m]."""
    force = damping * v
    if part.effective_mass > 0.0 and part.step > 0.0:
        most = 0.5 * part.effective_mass / part.step * abs(v)
        force = min(max(force, -most), most)
    return force


@kernel
def steady_force(c, motion):
    """Return what resists a piston besides dry friction [N]: damping, springs."""
    return _damped(c, motion.v, piston_damping(c, motion)) + piston_spring_force(c, motion)


@kernel
def piston_resistance(c, motion):
    """Return the force that a piston in this `Motion` meets [N], against +v."""
    return dry_force(c, motion.bristle, motion.v, dry_level(c, motion)) + steady_force(c, motion)


@kernel
def joint_resistance(j, motion):
    """Return the generalised force that a joint in this `Motion` meets [N or N m], against +v."""
    steady = _damped(j, motion.v, joint_damping(j, motion)) + joint_spring_force(j, motion)
    return dry_force(j, motion.bristle, motion.v, joint_dry_level(j, motion)) + steady
