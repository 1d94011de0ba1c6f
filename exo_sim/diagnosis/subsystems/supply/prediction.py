"""The predicted pressure upstream of the valves under a given flow."""

from __future__ import annotations

from exo_sim.physics import chamber
from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects import supply_droop, supply_regulator


@kernel
def follow_supply(world, time, drawn, offset, out):
    """Run accumulator and regulator along a drawn flow.

    Args:
        world: Record WORLD, shape (1,).
        time, drawn: [s] and [kg/s], shape (n,).
        offset: Of the set pressure [Pa].
        out: Pressure upstream of the valves [Pa], shape (n,).
    """
    w = world[0]
    k, r, t_s = w.k, w.r, w.supply_temperature
    source = w.supply_pressure + offset
    cp = k * r / (k - 1.0)
    tank = supply_droop.present(w.supply_droop)
    volume = w.supply_droop.volume
    mass, energy = 0.0, 0.0
    if tank:
        energy = source * volume / (k - 1.0)
        mass = source * volume / (r * t_s)
    lagged, held = 0.0, 0.0
    for i in range(time.size):
        p_source = supply_regulator.pressure(w.supply_regulator, source, held)
        out[i] = chamber.pressure(energy, volume, k) if tank else p_source
        if i + 1 == time.size:
            break
        h = time[i + 1] - time[i]
        flow = drawn[i]
        if tank:
            steps = 1 + min(int(2.0 * h * k * r * t_s * w.supply_droop.conductance / volume), 200)
            flow = 0.0
            for _ in range(steps):
                p = chamber.pressure(energy, volume, k)
                fed = supply_droop.feed(w.supply_droop, p_source, p)
                t = chamber.temperature(energy, mass, k, r)
                mass = max(mass + h / steps * (fed - drawn[i]), 1e-9)
                energy = max(energy + h / steps * cp * (fed * t_s - drawn[i] * t), 1e-6)
                flow += fed / steps
        lagged = supply_regulator.follow(w.supply_regulator, lagged, flow, h, 0.0)
        held = supply_regulator.stick(w.supply_regulator, held, lagged)
