"""Known limits of wall heat transfer: closed forms and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from physics.air import CV, PA, K, R
from physics.stepping import bench, drive, hold, tank

from exo_sim.physics import state


def test_relaxes_to_the_plateau_after_an_adiabatic_fill() -> None:
    gas = tank(1e-3, 5e-6, dt=1e-3)
    gas.fill(np.zeros(1), PA, PA)
    hold(gas, 1.0, 1.2)
    assert gas.temperatures()[0, 0] == pytest.approx(387.947821155, rel=1e-8)
    gas.cylinders["wall_heat_transfer"]["conductance_1"] = 10.0
    hold(gas, 0.0, 15.0)
    assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(7e5 * 293.15 / 387.947821155, rel=1e-7)
    assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(5.2895e5, abs=6.0)


def test_cools_exponentially_at_constant_volume() -> None:
    gas = tank(1e-4, 5e-6, dt=1e-3)
    gas.cylinders["wall_heat_transfer"]["conductance"] = 0.8
    gas.fill(np.zeros(1), 6e5, 6e5, temperature=353.15)
    tau = 6e5 * 1e-4 / (R * 353.15) * CV / 0.8
    hold(gas, 0.0, 0.5)
    assert gas.temperatures()[0] - 293.15 == pytest.approx(60.0 * math.exp(-0.5 / tau), rel=1e-6)


def test_sealed_piston_shows_the_complex_polytropic_exponent() -> None:
    for scaled, size, degrees in ((0.1, 1.004741, 2.259), (1 / math.sqrt(K), 1.183216, 9.594068), (10.0, 1.396601, 1.625)):
        gas = bench(p_1=6e5, p_2=6e5)
        mass = gas.integrated[0, state.MASS_1]
        tau = 0.5
        gas.cylinders["wall_heat_transfer"]["conductance_1"] = mass * CV / tau
        period = 2 * math.pi * tau / scaled
        gas.dt = period / 2000
        phase = np.arange(2000 * (4 if scaled < 5 else 12)) * 2 * math.pi / 2000
        found = drive(gas, 0.05 * (1.0 + 1e-4 * np.sin(phase)))[:, 0] / 6e5
        last = slice(-2000, None)
        n = 2.0 * np.mean(found[last] * np.exp(-1j * phase[last])) / (1j * 1e-4)
        assert abs(n) == pytest.approx(size, rel=2e-4)
        assert math.degrees(np.angle(n)) == pytest.approx(degrees, abs=0.02)
