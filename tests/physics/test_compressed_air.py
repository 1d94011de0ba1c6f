"""Designers' numbers of compressed air against hand calculations and published values."""

import math

import pytest

from exo_sim.physics.compressed_air import Bottle, compressor_power, exergy, free_air, tank_volume


def test_free_air_is_that_of_iso_8778():
    """1.185 kg/m^3 at 20 C, 100 kPa, 65 % relative humidity; humid air by its partial pressures agrees."""
    vapour = 0.65 * 2339.0  # saturation at 20 C [Pa]
    humid = (100e3 - vapour) / (287.05 * 293.15) + vapour / (461.5 * 293.15)
    assert 1.0 / free_air(1.0) == pytest.approx(humid, rel=4e-3)


def test_exergy_of_seven_bar_air():
    """Saidur et al. (2010) and others: isothermal compression to 7 bar absolute takes about 164 kJ/kg, 0.195 MJ a m^3 ANR."""
    assert exergy(7e5, 1e5) == pytest.approx(163.7e3, rel=1e-3)
    assert exergy(7e5, 1e5) / free_air(1.0) == pytest.approx(194e3, rel=2e-3)
    assert exergy(1e5, 1e5) == 0.0


def test_compressor_divides_by_its_efficiency():
    assert compressor_power(600.0, 0.6) == pytest.approx(1000.0)


def test_a_perfect_gas_would_let_a_bottle_last_a_tenth_longer():
    bottle = Bottle(2e-3, 300e5)
    perfect = 2e-3 * (300e5 - 10e5) / (287.05 * 293.15)
    assert perfect / bottle.usable(10e5) == pytest.approx(1.108, abs=0.005)
    assert bottle.lasts(0.01, 10e5) == pytest.approx(62.2, abs=0.1)
    assert bottle.lasts(0.0, 10e5) == math.inf
    assert bottle.usable(301e5) == 0.0


def test_tank_sags_as_an_adiabatic_volume_does():
    """Mass and energy balance of a volume that loses gas at its own temperature, to first order in what it loses."""
    volume, pressure, lost = 5e-3, 10e5, 1e-5
    mass = pressure * volume / (287.05 * 293.15)
    after = pressure * ((mass - lost) / mass) ** 1.4
    assert tank_volume(lost, pressure - after) == pytest.approx(volume, rel=1e-3)
