"""The paper's two chambers in plain Python, as a user would write them: no package of ours, nothing compiled."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class PlainCylinder:
    """Mass and energy of two chambers behind four metering edges, with a leak past the piston.

    Args:
        k, r: Heat capacity ratio and gas constant [J/(kg K)].
        supply, exhaust, temperature: Pressures [Pa], temperature of supply and surroundings [K].
        area_1, area_2, stroke: Piston areas [m^2], stroke [m].
    """

    def __init__(
        self, k: float, r: float, supply: float, exhaust: float, temperature: float, area_1: float, area_2: float, stroke: float
    ) -> None:
        self.k, self.r = k, r
        self.supply, self.exhaust, self.temperature = supply, exhaust, temperature
        self.area_1, self.area_2, self.stroke = area_1, area_2, stroke
        self.critical = (2.0 / (k + 1.0)) ** (k / (k - 1.0))
        self.choked = math.sqrt(k / r * (2.0 / (k + 1.0)) ** ((k + 1.0) / (k - 1.0)))

    def flow(self, area: float, p_a: float, t_a: float, p_b: float, t_b: float) -> float:
        """Return the nozzle flow from a to b, either way [kg/s]."""
        if p_a < p_b:
            return -self.flow(area, p_b, t_b, p_a, t_a)
        ratio = p_b / p_a
        if ratio <= self.critical:
            return area * p_a * self.choked / math.sqrt(t_a)
        k = self.k
        part = ratio ** (2.0 / k) - ratio ** ((k + 1.0) / k)
        return area * p_a * math.sqrt(2.0 * k / ((k - 1.0) * self.r * t_a) * max(part, 0.0))

    def rates(
        self, state: Sequence[float], x: float, v: float, command: float, valve: float, dead_1: float, dead_2: float, leak: float
    ) -> tuple[float, float, float, float]:
        """Return d(mass 1, energy 1, mass 2, energy 2)/dt."""
        k, r = self.k, self.r
        cp = k * r / (k - 1.0)
        m_1, u_1, m_2, u_2 = state
        p_1 = (k - 1.0) * u_1 / (dead_1 + self.area_1 * x)
        p_2 = (k - 1.0) * u_2 / (dead_2 + self.area_2 * (self.stroke - x))
        t_1, t_2 = (k - 1.0) * u_1 / (m_1 * r), (k - 1.0) * u_2 / (m_2 * r)
        area = abs(command) * valve
        up, down = (self.supply, self.exhaust) if command > 0.0 else (self.exhaust, self.supply)
        w_1 = self.flow(area, up, self.temperature, p_1, t_1)
        w_2 = self.flow(area, down, self.temperature, p_2, t_2)
        w_l = self.flow(leak, p_1, t_1, p_2, t_2)
        h_1 = w_1 * cp * (self.temperature if w_1 > 0.0 else t_1)
        h_2 = w_2 * cp * (self.temperature if w_2 > 0.0 else t_2)
        h_l = w_l * cp * (t_1 if w_l > 0.0 else t_2)
        return w_1 - w_l, h_1 - h_l - p_1 * self.area_1 * v, w_2 + w_l, h_2 + h_l + p_2 * self.area_2 * v

    def pressures(
        self, time: Array, x: Array, command: Array, first: Sequence[float], valve: float, dead_1: float, dead_2: float, leak: float
    ) -> Array:
        """Return both pressures at every sample, shape (n, 2) [Pa]: one Runge-Kutta step of fourth order a sample.

        The command is held between samples and the piston moves evenly; `first` is where the pressures begin, the gas as warm as
        its surroundings.
        """
        k, r = self.k, self.r
        v_1, v_2 = dead_1 + self.area_1 * x[0], dead_2 + self.area_2 * (self.stroke - x[0])
        y = [first[0] * v_1 / (r * self.temperature), first[0] * v_1 / (k - 1.0),
             first[1] * v_2 / (r * self.temperature), first[1] * v_2 / (k - 1.0)]  # fmt: skip
        out = np.empty((len(time), 2))
        times, places, commands = time.tolist(), x.tolist(), command.tolist()
        numbers = (valve, dead_1, dead_2, leak)
        for i in range(len(times)):
            here = places[i]
            out[i, 0] = (k - 1.0) * y[1] / (dead_1 + self.area_1 * here)
            out[i, 1] = (k - 1.0) * y[3] / (dead_2 + self.area_2 * (self.stroke - here))
            if i + 1 < len(times):
                h = times[i + 1] - times[i]
                speed = (places[i + 1] - here) / h
                middle, there, u = here + 0.5 * h * speed, places[i + 1], commands[i]
                a = self.rates(y, here, speed, u, *numbers)
                b = self.rates([s + 0.5 * h * d for s, d in zip(y, a)], middle, speed, u, *numbers)
                c = self.rates([s + 0.5 * h * d for s, d in zip(y, b)], middle, speed, u, *numbers)
                d = self.rates([s + h * e for s, e in zip(y, c)], there, speed, u, *numbers)
                y = [s + h / 6.0 * (e + 2.0 * f + 2.0 * g + z) for s, e, f, g, z in zip(y, a, b, c, d)]
        return out
