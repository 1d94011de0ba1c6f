"""How a valve with independent edges gets a force: by a plan of both pressures along a cycle, or with one chamber let off.

The paper's valve moves both chambers with one spool, so both stay under pressure, and each stroke fills the chamber that grows with
gas that pushes against the other. With an edge for each chamber the force leaves one number free. Where the cycle is known ahead,
`pressure_plan` says which pressures cost least and `follow` keeps near them; where it is not, `meter` lets the chamber that does not push
off to the exhaust: it draws air from there when it grows. What a chamber needs follows from the same inverse of its pressure dynamics as
`valve_control.invert` (corrected equation 34).
"""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.nodes import path_areas
from exo_sim.physics.nozzle import choked_flow, flow

#: Share of a choked path's flow below which more opening would not help.
_LEAST = 0.05
#: Time constant with which pressures come to their plan [s].
_TO_PLAN = 0.1
#: Tank and chamber exchange gas where the lower pressure is less than this share of the higher, and the tank is this near its own.
_APART, _KEPT = 0.98, 0.1
#: How near a bound a pressure counts as there, of the supply's over the exhaust's, and what is left of its share in corrections then.
_NEAR_BOUND, _AT_BOUND = 0.02, 0.01


@kernel
def edge_command(share: float, overlap: float) -> float:
    """Return the command, 0 to 1, that opens an edge to a share of its area; its overlap is passed over."""
    if share <= 0.0:
        return 0.0
    return min(overlap + (1.0 - overlap) * share, 1.0)


@kernel
def chamber_command(wanted, p, t, v, fed, let_off, overlap_fed, overlap_let_off, p_s, t_s, p_e, t_e, k, r):
    """Return the command of a chamber whose pressure is to change at a wanted rate by its valve alone.

    Args:
        wanted: Rate of the pressure by gas through the valve [Pa/s].
        p, t, v: Pressure [Pa], temperature [K], volume [m^3] of the chamber.
        fed, let_off: Areas of its edges at full command [m^2].
        overlap_fed, overlap_let_off: Commands at which they begin to open.
        p_s, t_s, p_e, t_e: Supply and exhaust.
        k, r: The gas.
    """
    per_flow = k * r / v
    if wanted >= 0.0:
        into = max(flow(fed, p_s, t_s, p, t, k, r), _LEAST * choked_flow(fed, p_s, t_s, k, r))
        return edge_command(wanted / (per_flow * into * t_s), overlap_fed)
    if p > p_s:  # squeezed above the supply: what leaves goes back there
        back = max(flow(fed, p, t, p_s, t_s, k, r), _LEAST * choked_flow(fed, p_s, t_s, k, r))
        return edge_command(-wanted / (per_flow * back * t), overlap_fed)
    out = max(flow(let_off, p, t, p_e, t_e, k, r), _LEAST * choked_flow(let_off, p_s, t_s, k, r))
    return -edge_command(-wanted / (per_flow * out * t), overlap_let_off)


@kernel
def through_tank(wanted, p, t, v, area, p_t, t_t, near, k, r):
    """Return the command, 0 to 1, of a chamber's path to a recovery tank, and the rate of its pressure that is left to its other edges.

    The tank comes first wherever pressures allow it, as long as its own stays within `_KEPT` of the one that the plan reckons with.

    Args:
        wanted: Rate of the pressure by gas [Pa/s].
        p, t, v: Pressure [Pa], temperature [K], volume [m^3] of the chamber.
        area: Of the path [m^2]; 0 where there is no tank.
        p_t, t_t: Of the tank.
        near: Pressure that it is kept near [Pa].
        k, r: The gas.
    """
    if area <= 0.0:
        return 0.0, wanted
    if wanted > 0.0 and p < _APART * p_t and p_t > (1.0 - _KEPT) * near:
        by_tank = k * r / v * flow(area, p_t, t_t, p, t, k, r) * t_t
    elif wanted < 0.0 and p_t < _APART * p and p_t < (1.0 + _KEPT) * near:
        by_tank = -k * r / v * flow(area, p, t, p_t, t_t, k, r) * t
    else:
        return 0.0, wanted
    if abs(by_tank) >= abs(wanted):
        return wanted / by_tank, 0.0
    return 1.0, wanted - by_tank


@kernel
def meter(c, wanted, rate, v, p_1, t_1, p_2, t_2, v_1, v_2, p_s, t_s, p_e, t_e, k, r):
    """Return the commands of both chambers for which the rod force changes at a wanted rate, the chamber that does not push let off.

    Args:
        c: Record of the cylinder.
        wanted: Rod force [N]; its sign says which chamber pushes.
        rate: Wanted rate of the rod force, error included [N/s].
        v: Piston speed [m/s].
        p_1, t_1, v_1, p_2, t_2, v_2: Pressure [Pa], temperature [K], volume [m^3] of the chambers.
        p_s, t_s, p_e, t_e: Supply and exhaust.
        k, r: The gas.
    """
    fed_1, _, fed_2, _ = path_areas(c, 1.0, 1.0)
    _, let_off_1, _, let_off_2 = path_areas(c, -1.0, -1.0)
    edges = c.valve_edges
    by_motion = -k * (p_1 * c.area_1 * c.area_1 / v_1 + p_2 * c.area_2 * c.area_2 / v_2) * v
    if wanted >= 0.0 or c.single_acting > 0.0:
        by_other = 0.0
        if c.single_acting == 0.0:
            w = flow(let_off_2, p_2, t_2, p_e, t_e, k, r)
            by_other = k * r / v_2 * w * (t_2 if w > 0.0 else t_e) * c.area_2
        else:
            by_motion = -k * p_1 * c.area_1 * c.area_1 / v_1 * v
        u_1 = chamber_command(
            (rate - by_motion - by_other) / c.area_1, p_1, t_1, v_1, fed_1, let_off_1, edges.overlap_supply_1, edges.overlap_exhaust_1,
            p_s, t_s, p_e, t_e, k, r,
        )  # fmt: skip
        return u_1, -1.0
    w = flow(let_off_1, p_1, t_1, p_e, t_e, k, r)
    by_other = -k * r / v_1 * w * (t_1 if w > 0.0 else t_e) * c.area_1
    u_2 = chamber_command(
        -(rate - by_motion - by_other) / c.area_2, p_2, t_2, v_2, fed_2, let_off_2, edges.overlap_supply_2, edges.overlap_exhaust_2,
        p_s, t_s, p_e, t_e, k, r,
    )  # fmt: skip
    return -1.0, u_2


@kernel
def follow(c, rate, v, ref_1, rate_1, ref_2, rate_2, p_1, t_1, p_2, t_2, v_1, v_2, p_s, t_s, p_e, t_e, p_t, t_t, near, k, r):
    """Return the commands of both chambers, and of their paths to a tank, for which the rod force changes at a wanted rate, near a plan.

    Both chambers change as planned; what that leaves of the force's rate falls to the chambers in proportion to the square of the force
    that a gram of gas makes in them, and to none at its bounds. The pressures are drawn to the plan's slowly: the force comes first.

    Args:
        c: Record of the cylinder.
        rate: Wanted rate of the rod force, error included [N/s].
        v: Piston speed [m/s].
        ref_1, rate_1, ref_2, rate_2: Planned pressures [Pa] and their rates [Pa/s].
        p_1, t_1, v_1, p_2, t_2, v_2: Pressure [Pa], temperature [K], volume [m^3] of the chambers.
        p_s, t_s, p_e, t_e: Supply and exhaust.
        p_t, t_t, near: The recovery tank, and the pressure that it is kept near; anything where the cylinder has no path to one.
        k, r: The gas.
    """
    fed_1, _, fed_2, _ = path_areas(c, 1.0, 1.0)
    _, let_off_1, _, let_off_2 = path_areas(c, -1.0, -1.0)
    edges = c.valve_edges
    change_1 = rate_1 + (ref_1 - p_1) / _TO_PLAN
    change_2 = rate_2 + (ref_2 - p_2) / _TO_PLAN
    rest = rate - (c.area_1 * change_1 - c.area_2 * change_2)
    close = _NEAR_BOUND * (p_s - p_e)
    share_1, share_2 = (c.area_1 / v_1) ** 2, (c.area_2 / v_2) ** 2
    if (p_1 > p_s - close) if rest > 0.0 else (p_1 < p_e + close):
        share_1 *= _AT_BOUND
    if (p_2 < p_e + close) if rest > 0.0 else (p_2 > p_s - close):
        share_2 *= _AT_BOUND
    whole = share_1 + share_2
    change_1 += share_1 / whole * rest / c.area_1
    change_2 -= share_2 / whole * rest / c.area_2
    by_gas_1 = change_1 + k * p_1 * c.area_1 * v / v_1
    by_gas_2 = change_2 - k * p_2 * c.area_2 * v / v_2
    w_1, by_gas_1 = through_tank(by_gas_1, p_1, t_1, v_1, c.tank_area, p_t, t_t, near, k, r)
    w_2, by_gas_2 = through_tank(by_gas_2, p_2, t_2, v_2, c.tank_area, p_t, t_t, near, k, r)
    u_1 = chamber_command(
        by_gas_1, p_1, t_1, v_1, fed_1, let_off_1, edges.overlap_supply_1, edges.overlap_exhaust_1, p_s, t_s, p_e, t_e, k, r
    )
    u_2 = chamber_command(
        by_gas_2, p_2, t_2, v_2, fed_2, let_off_2, edges.overlap_supply_2, edges.overlap_exhaust_2, p_s, t_s, p_e, t_e, k, r
    )
    return u_1, u_2, w_1, w_2
