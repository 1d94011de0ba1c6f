"""The rates of a hose: one volume behind an orifice, or a short line of three between which gas has inertia and rubs at the wall."""

from __future__ import annotations

import math

from exo_sim.trials.whole_machines.compiled import kernel
from exo_sim.trials.whole_machines.gas_laws import ELLIPSE, orifice

#: Volumes of a line.
CELLS = 3


@kernel
def hose_rates(y, out, at, p_chamber, t_chamber, net, enthalpy, needle, p):
    """Write the rates of one hose fed with (net, enthalpy) at the valve; return what enters the chamber, mass [kg/s] and enthalpy [W].

    `needle` is the area of the cushion's needle where it acts on gas that leaves, else 0.
    """
    k = p.heat_ratio
    cp = k * p.gas_constant / (k - 1.0)
    if p.hose_kind == 1.0:
        volume = p.hose_volume
        p_cell = (k - 1.0) * y[at + 1] / volume
        t_cell = p_cell * volume / (y[at] * p.gas_constant)
        area = p.hose_area
        if needle > 0.0 and p_chamber > p_cell:
            area = needle
        w = orifice(area, p_cell, t_cell, p_chamber, t_chamber, ELLIPSE, p.hose_b, 0.5, 0.0, p)
        carried = cp * w * (t_cell if w > 0.0 else t_chamber)
        out[at] = net - w
        out[at + 1] = enthalpy - carried + p.hose_heat * (p.room - t_cell)
        return w, carried
    section = 0.25 * math.pi * p.hose_bore * p.hose_bore
    length = p.hose_length / CELLS
    volume = section * length
    w_in, h_in = net, enthalpy
    for i in range(CELLS):
        here = at + 2 * i
        p_here = (k - 1.0) * y[here + 1] / volume
        t_here = p_here * volume / (y[here] * p.gas_constant)
        if i + 1 < CELLS:
            p_next = (k - 1.0) * y[here + 3] / volume
            t_next = p_next * volume / (y[here + 2] * p.gas_constant)
        else:
            p_next, t_next = p_chamber, t_chamber
        flow = at + 2 * CELLS + i
        w = y[flow]
        density = 0.5 * (p_here / t_here + p_next / t_next) / p.gas_constant
        speed = w / (density * section)
        reynolds = 4.0 * abs(w) / (math.pi * p.hose_bore * 1.8e-5)
        # laminar, then Blasius; the larger of both joins them
        factor = max(64.0 / max(reynolds, 1e-6), 0.3164 / max(reynolds, 2e3) ** 0.25)
        lost = factor * length / p.hose_bore * 0.5 * density * speed * abs(speed)
        if i == CELLS - 1:
            lost += 0.75 * density * speed * abs(speed)  # ends and fittings
        out[flow] = section / length * (p_here - p_next - lost)
        h = cp * w * (t_here if w > 0.0 else t_next)
        out[here] = w_in - w
        out[here + 1] = h_in - h + p.hose_heat / CELLS * (p.room - t_here)
        w_in, h_in = w, h
    return w_in, h_in
