"""A cylinder to whose gas nothing is added: the terms of `plant.cylinder_rates` that are left, in the same order.

Asking for a dozen effects that are absent takes longer than the paper's equations do, and most cylinders have none.
"""

from __future__ import annotations

from exo_sim.physics import chamber, gas
from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects import unknown
from exo_sim.physics.nodes import path_areas, volumes
from exo_sim.physics.state import (
    DRAWN,
    DRAWN_ENTHALPY,
    ENERGY_1,
    ENERGY_2,
    EXHAUSTED,
    EXHAUSTED_ENTHALPY,
    INTEGRATED,
    MASS_1,
    MASS_2,
    WORK,
)


@kernel
def plain(c) -> bool:
    """Say whether a double-acting cylinder has none of the effects that act on its gas between valve and piston."""
    leak, wall, hose = c.external_leakage, c.wall_heat_transfer, c.line_restriction.area
    leaks = leak.area_1 + leak.area_2 + leak.laminar_1 + leak.laminar_2 + c.piston_leakage.area + c.piston_leakage.laminar
    heat = wall.conductance + wall.conductance_1 + wall.conductance_2 + c.moving_wall_temperature.heat_capacity
    throttles = hose + c.end_cushioning.length + c.critical_ratio.ratio
    return leaks + heat + throttles + c.single_acting == 0.0 and not unknown.present(c.unknown)


@kernel
def plain_rates(world, c, y, dy, base, x, v, opening, p_s, t_s, p_e, t_e):
    """Write d/dt of a plain cylinder's integrated state; arguments and result are those of `plant.cylinder_rates`."""
    for j in range(INTEGRATED):
        dy[base + j] = 0.0
    k, r = world.k, world.r
    cp = k * r / (k - 1.0)
    v_1, v_2 = volumes(c, x)
    p_1 = chamber.pressure(y[base + ENERGY_1], v_1, k)
    p_2 = chamber.pressure(y[base + ENERGY_2], v_2, k)
    t_1 = chamber.temperature(y[base + ENERGY_1], y[base + MASS_1], k, r)
    t_2 = chamber.temperature(y[base + ENERGY_2], y[base + MASS_2], k, r)
    a_s1, a_1e, a_s2, a_2e = path_areas(c, opening)
    in_1 = gas.flow(a_s1, p_s, t_s, p_1, t_1, k, r)
    out_1 = gas.flow(a_1e, p_1, t_1, p_e, t_e, k, r)
    in_2 = gas.flow(a_s2, p_s, t_s, p_2, t_2, k, r)
    out_2 = gas.flow(a_2e, p_2, t_2, p_e, t_e, k, r)
    h_in_1 = in_1 * cp * (t_s if in_1 > 0.0 else t_1)
    h_out_1 = out_1 * cp * (t_1 if out_1 > 0.0 else t_e)
    h_in_2 = in_2 * cp * (t_s if in_2 > 0.0 else t_2)
    h_out_2 = out_2 * cp * (t_2 if out_2 > 0.0 else t_e)
    push_1, push_2 = p_1 * c.area_1 * v, p_2 * c.area_2 * v
    dy[base + MASS_1] = in_1 - out_1
    dy[base + MASS_2] = in_2 - out_2
    dy[base + ENERGY_1] = h_in_1 - h_out_1 - push_1
    dy[base + ENERGY_2] = h_in_2 - h_out_2 + push_2
    drawn, h_drawn = in_1 + in_2, h_in_1 + h_in_2
    dy[base + DRAWN] = drawn
    dy[base + DRAWN_ENTHALPY] = h_drawn
    dy[base + EXHAUSTED] = out_1 + out_2
    dy[base + EXHAUSTED_ENTHALPY] = h_out_1 + h_out_2
    dy[base + WORK] = push_1 - push_2
    return drawn, h_drawn, out_1 + out_2, h_out_1 + h_out_2
