"""Between piston and joint: rigid unless a mount gives or a gap plays; then the piston sits where the forces balance.

The rod is taken as massless: gas force less friction equals what the transmission carries.
"""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects import backlash, transmission_compliance
from exo_sim.physics.resistance import bristle_stiffness, dry_level


@kernel
def gives(c) -> bool:
    """Say whether the piston can be elsewhere than the joint has it."""
    if transmission_compliance.present(c.transmission_compliance) or c.backlash.gap > 0.0:
        return True
    return c.drive_stiffness > 0.0 or c.drive_gap > 0.0


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


@kernel
def piston_at(world, c, p_1: float, p_2: float, from_x: float, x: float, z: float) -> float:
    """Return where the piston comes to rest between gas, dry friction and transmission [m].

    The chambers answer adiabatically from (p_1, p_2) at `from_x`; Newton's method on a force that falls with the piston's position,
    kept inside a bracket.
    """
    spring = stiffness(c)
    low, high = x - 0.5 * c.stroke - 0.01, x + 0.5 * c.stroke + 0.01
    level = dry_level(c, 0.0, p_1 - world.atmosphere, p_2 - world.atmosphere)
    grip = bristle_stiffness(c, level) if level > 0.0 else 0.0
    v_1 = c.dead_volume_1 + c.area_1 * from_x
    v_2 = c.dead_volume_2 + c.area_2 * (c.stroke - from_x)
    rod = world.atmosphere * (c.area_1 - c.area_2)
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
        drag = min(max(drag, -level), level)
        force = q_1 * c.area_1 - q_2 * c.area_2 - rod - drag - carried(c, piston, x)
        if force > 0.0:
            low = piston
        else:
            high = piston
        slope += world.k * (q_1 * c.area_1**2 / n_1 + (q_2 * c.area_2**2 / n_2 if c.single_acting == 0.0 else 0.0))
        new = piston + force / slope
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - piston) < 1e-12:
            return new
        piston = new
    return piston
