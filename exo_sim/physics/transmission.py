"""Between piston and joint: rigid unless a mount gives or a gap plays; then the piston sits where the forces balance.

The piston is taken as massless: gas force less what resists it equals what the transmission carries.
"""

from __future__ import annotations

from exo_sim.physics.compiled import inlined_kernel, kernel
from exo_sim.physics.conditions import Motion
from exo_sim.physics.effects import backlash, friction_smoothing, transmission_compliance, unknown
from exo_sim.physics.friction import bristle_stiffness, sharp_level
from exo_sim.physics.summed_effects import piston_damping, piston_spring_force

#: How far beyond its ends a piston behind a soft mount may be pushed [m]: there it rests on the end cap.
END_GIVE = 1e-3

#: Over how far the slope of a spring's force is taken [m].
NEARBY = 1e-6


@kernel
def plays(c) -> bool:
    """Return whether the transmission carries nothing while its load reverses."""
    return c.backlash.gap > 0.0 or c.drive_gap > 0.0


@kernel
def gives(c) -> bool:
    """Return whether the piston can be elsewhere than the joint has it."""
    return transmission_compliance.present(c.transmission_compliance) or c.drive_stiffness > 0.0 or plays(c)


@kernel
def stiffness(c) -> float:
    """Return the transmission's stiffness at the rod [N/m]: the mount's and the joint drive's, in series."""
    give = 0.0
    if transmission_compliance.present(c.transmission_compliance):
        give += 1.0 / c.transmission_compliance.stiffness
    if c.drive_stiffness > 0.0:
        give += c.arm * c.arm / c.drive_stiffness
    return 1.0 / give if give > 0.0 else backlash.CONTACT_STIFFNESS


@kernel
def play(c, deflection: float) -> float:
    """Return what is left of a deflection behind all free play [m]."""
    left = backlash.stretch(c.backlash, deflection)
    half = 0.5 * c.drive_gap * abs(c.arm)
    return left - min(max(left, -half), half)


@kernel
def carried(c, piston: float, x: float) -> float:
    """Return the force that the transmission carries to the joint [N] with the joint's side at x."""
    return stiffness(c) * play(c, piston - x)


@inlined_kernel
def piston_at(
    world, c, p_1: float, p_2: float, from_x: float, x: float, z: float, speed: float, span: float
) -> float:
    """Return where the piston comes to rest between gas, friction and transmission [m].

    The chambers answer adiabatically from (p_1, p_2) at `from_x`; Newton's method on a force that falls with the piston's
    position, kept inside a bracket.

    Args:
        from_x, speed: Where the piston was, and how fast it went there.
        x: Where the joint's side is.
        z: Deflection of the dry contact at `from_x`.
        span: Time that the move takes [s]; 0 where the piston is to keep its speed.
    """
    spring = stiffness(c)
    low, high = min(x, 0.0) - END_GIVE, max(x, c.stroke) + END_GIVE
    g_1, g_2 = p_1 - world.atmosphere, p_2 - world.atmosphere
    before = Motion(from_x, speed, z, g_1, g_2)
    level = sharp_level(c, before)
    smoothed = 0.0
    if friction_smoothing.present(c.friction_smoothing):  # then there is nothing that sticks
        smoothed, level = level, 0.0
    grip = bristle_stiffness(c, level) if level > 0.0 else 0.0
    v_1 = c.dead_volume_1 + c.area_1 * from_x
    v_2 = c.dead_volume_2 + c.area_2 * (c.stroke - from_x)
    steady = world.atmosphere * (c.area_1 - c.area_2) - unknown.acting(c.unknown, 0, from_x, speed, p_1, p_2)
    thick = piston_damping(c, before)
    if span > 0.0:
        thick /= span
    else:
        steady += thick * speed + friction_smoothing.creep(c.friction_smoothing, smoothed, speed)[0]
        thick = smoothed = 0.0
    piston = from_x
    for _ in range(20):
        n_1 = max(v_1 + c.area_1 * (piston - from_x), 0.01 * v_1)
        n_2 = max(v_2 - c.area_2 * (piston - from_x), 0.01 * v_2)
        q_1 = p_1 * (v_1 / n_1) ** world.k
        q_2 = p_2 * (v_2 / n_2) ** world.k if c.single_acting == 0.0 else world.atmosphere
        drag = grip * (z + piston - from_x)
        slope = spring if play(c, piston - x) != 0.0 else 0.0
        if abs(drag) < level:
            slope += grip
        spring_force = piston_spring_force(c, Motion(piston, speed, z, g_1, g_2))
        drag = min(max(drag, -level), level) + thick * (piston - from_x) + spring_force
        if smoothed > 0.0:
            creep, steep = friction_smoothing.creep(c.friction_smoothing, smoothed, (piston - from_x) / span)
            drag += creep
            slope += steep / span
        force = q_1 * c.area_1 - q_2 * c.area_2 - steady - drag - carried(c, piston, x)
        if force > 0.0:
            low = piston
        else:
            high = piston
        slope += thick + max((piston_spring_force(c, Motion(piston + NEARBY, speed, z, g_1, g_2)) - spring_force) / NEARBY, 0.0)
        slope += world.k * (q_1 * c.area_1**2 / n_1 + (q_2 * c.area_2**2 / n_2 if c.single_acting == 0.0 else 0.0))
        new = piston + force / slope
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - piston) < 1e-12:
            return new
        piston = new
    return piston
