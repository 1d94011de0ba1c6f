"""Compressed air in a designer's numbers: free air, exergy, compressor power, how long a bottle lasts, and the tank that evens it out."""

from __future__ import annotations

import math
from dataclasses import dataclass

from exo_sim.physics import real_air

#: The reference atmosphere of ISO 8778 (ANR): 20 C, 100 kPa, 65 % relative humidity: density [kg/m^3] and temperature [K].
FREE_AIR_DENSITY, FREE_AIR_TEMPERATURE = 1.185, 293.15

#: Power that isothermal compression would take over what a compressor takes, by default.
COMPRESSOR_EFFICIENCY = 0.6


def free_air(mass: float) -> float:
    """Return the volume of a mass of air at the reference of ISO 8778 [m^3]; mass in kg, or a flow of both.

    >>> round(60e3 * free_air(0.018), 1)
    911.4
    """
    return mass / FREE_AIR_DENSITY


def exergy(pressure: float, atmosphere: float = 101325.0, ambient: float = 293.15, r: float = 287.05) -> float:
    """Return the most work that a flow of gas can do, coming at the ambient temperature [J/kg]: R T0 ln(p/p0).

    Of a perfect gas (Bejan, Advanced Engineering Thermodynamics); what isothermal compression takes at the least.

    Args:
        pressure, atmosphere: Absolute [Pa].
        ambient: [K].
        r: Specific gas constant [J/(kg K)].

    >>> round(exergy(7e5, 1e5))
    163746
    """
    return r * ambient * math.log(pressure / atmosphere)


def compressor_power(exergy_flow: float, efficiency: float = COMPRESSOR_EFFICIENCY) -> float:
    """Return what a compressor takes to deliver a flow of exergy [W]; `efficiency` is its isothermal one."""
    return exergy_flow / efficiency


@dataclass(frozen=True)
class Bottle:
    """A bottle of air: volume [m^3], filling pressure, absolute [Pa], and temperature [K]."""

    volume: float = 2e-3
    pressure: float = 300e5
    temperature: float = 293.15

    def usable(self, until: float) -> float:
        """Return the mass that comes out at constant temperature before the pressure falls to `until` [Pa], as a real gas [kg].

        2 litres of 300 bar, emptied to 10 bar:

        >>> round(Bottle().usable(10e5), 3)
        0.622
        """
        if until >= self.pressure:
            return 0.0
        full, empty = real_air.density(self.pressure, self.temperature), real_air.density(until, self.temperature)
        return self.volume * (full - empty)

    def lasts(self, flow: float, until: float) -> float:
        """Return for how long it feeds a mass flow [kg/s] before its pressure falls to `until` [s]; infinite where none is drawn."""
        return self.usable(until) / flow if flow > 0.0 else math.inf


def tank_volume(swing: float, sag: float, temperature: float = 293.15, k: float = 1.4, r: float = 287.05) -> float:
    """Return the volume of a tank, fed evenly, whose pressure sags so much while a mass beyond the mean flow is drawn [m^3].

    Adiabatic, dp = k R T dm / V: within a stride the walls have no time to help.

    Args:
        swing: Largest mass drawn beyond the mean flow, from the fullest to the emptiest moment of a cycle [kg].
        sag: Fall of pressure [Pa].
        temperature: Of the tank [K].
        k, r: Ratio of specific heats; specific gas constant [J/(kg K)].

    >>> round(1e3 * tank_volume(1e-3, 0.5e5), 3)
    2.356
    """
    return k * r * temperature * swing / sag
