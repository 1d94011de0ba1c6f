"""The force loops of the valves of a machine that nobody wears: what each valve gets so that its rod comes to make the force wanted."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.control.metering import meter
from exo_sim.control.valve_control import ValveGains, invert, pi
from exo_sim.physics import plant
from exo_sim.simulation.plugin import PneumaticPlugin

Array = NDArray[np.float64]


class ForceLoops:
    """One loop a cylinder, and what it remembers.

    Args:
        plugin: The cylinders; their commands are set.
        law: "model" or "pi".
        dt: Time between two calls [s].
    """

    def __init__(self, plugin: PneumaticPlugin, law: str, dt: float) -> None:
        self._plugin, self._law, self._dt, self._gains = plugin, law, dt, ValveGains()
        self.reset()

    def reset(self) -> None:
        """Forget what was."""
        n = len(self._plugin.links)
        self._before, self._integral = np.zeros(n), np.zeros(n)

    def open_valves(self, data: mujoco.MjData, rods: Array, first: bool) -> None:
        """Set the commands for the rod forces wanted [N], shape (n,); at the first step they have no rate yet."""
        plugin, gains, dt = self._plugin, self._gains, self._dt
        gas, x = plugin.pneumatics, plugin.lengths
        pressures, temperatures, w = gas.sensed_pressures(x), gas.temperatures(), gas.world[0]
        for i, c in enumerate(gas.cylinders):
            (p_1, p_2), (t_1, t_2) = pressures[i], temperatures[i]
            force = p_1 * c["area_1"] - p_2 * c["area_2"] - w["atmosphere"] * (c["area_1"] - c["area_2"])
            error = rods[i] - force
            if self._law == "pi":
                scale = (w["supply_pressure"] - w["atmosphere"]) * c["area_1"]
                plugin.command[i], self._integral[i] = pi(error, scale, self._integral[i], gains.proportional, gains.integral, dt)
                if c["independent"] > 0.0:
                    pushes = rods[i] >= 0.0 or c["single_acting"] > 0.0
                    plugin.command_2[i] = -1.0 if pushes else -plugin.command[i]
                    plugin.command[i] = plugin.command[i] if pushes else -1.0
                continue
            rate = 0.0 if first else (rods[i] - self._before[i]) / dt
            v_1, v_2 = plant.volumes(c, x[i])
            if c["independent"] > 0.0:
                speed = data.actuator_velocity[plugin.links[i].actuator]
                plugin.command[i], plugin.command_2[i] = meter(
                    c, rods[i], rate + error / gains.closing_time, speed, p_1, t_1, p_2, t_2, v_1, v_2, w["supply_pressure"],
                    w["supply_temperature"], w["exhaust_pressure"], w["ambient"], w["k"], w["r"],
                )  # fmt: skip
                continue
            opening = invert(
                rate + error / gains.closing_time, data.actuator_velocity[plugin.links[i].actuator], p_1, t_1, p_2, t_2, v_1, v_2,
                c["area_1"], c["area_2"], c["valve_area"], w["supply_pressure"], w["supply_temperature"], w["exhaust_pressure"],
                w["ambient"], w["k"], w["r"],
            )  # fmt: skip
            plugin.command[i] = min(max(opening, -1.0), 1.0)
        self._before[:] = rods
