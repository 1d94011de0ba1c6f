"""Gas that is under way in a long hose when the piston closes its port."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from exo_sim.physics.effects import line_restriction
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world

K, R = 1.4, 287.05


def cushioned(dt: float) -> Pneumatics:
    """Return a cylinder of 20 mm behind 1.6 m of hose, whose cushion leaves a thirty-fifth of the hose's area."""
    cylinder = paper_cylinder(0.020, 0.008, 0.16, 0.77e-6, 5e-6, 4e-6)
    hose, cushion = cylinder["line_restriction"], cylinder["end_cushioning"]
    hose["area"], hose["length"], hose["volume"] = 1.5e-6, 1.6, 7.7e-6
    cushion["length"], cushion["area"] = 0.018, 4.3e-8
    gas = Pneumatics(paper_world(), cylinder, dt=dt)
    gas.fill(np.array([0.139]), 4e5, 4e5)
    return gas


def to_and_fro(gas: Pneumatics, seconds: float) -> NDArray[np.float64]:
    """Move the piston into its cushion and back under a valve that is thrown over; return pressures every 5 ms, shape (n, 2) [Pa]."""
    steps, every = round(seconds / gas.dt), round(5e-3 / gas.dt)
    time = np.arange(steps + 1) * gas.dt
    x = 0.139 + 0.012 * np.sin(4.0 * math.pi * time)
    found = []
    for i in range(steps):
        towards_1 = math.sin(10.0 * math.pi * (i // every) * 5e-3 + 0.3) > 0.0
        gas.advance(x[i : i + 1], x[i + 1 : i + 2], np.array([0.8 if towards_1 else -0.8]))
        if (i + 1) % every == 0:
            found.append(gas.pressures(x[i + 1 : i + 2])[0].copy())
    return np.array(found)


@pytest.mark.parametrize("dt", [1e-3, 5e-4])
def test_it_is_stopped_and_what_it_held_is_kept(dt: float) -> None:
    gas = cushioned(dt)
    found, fine = to_and_fro(gas, 0.3), to_and_fro(cushioned(2e-5), 0.3)
    assert np.abs(found - fine).max() < 0.12 * fine.max()  # it is stopped within microseconds, and how many makes so much
    assert np.abs(found[-10:] - fine[-10:]).max() < 0.01 * fine.max()
    books = gas.books()
    assert abs(books.mass_residual) < 1e-12 and abs(books.energy_residual) < 1e-12


def test_steadily_the_cushion_lets_out_what_it_lets_out_of_a_short_hose() -> None:
    hose = cushioned(1e-3).cylinders["line_restriction"][0].copy()
    outlet, p_port, p_chamber = 4.3e-8, 2e5, 5e5
    steady = line_restriction.flow(hose, outlet, p_port, 293.0, p_chamber, 293.0, K, R)
    halves = line_restriction.resistances(hose, outlet, p_port, 293.0, p_chamber, 293.0, K, R)
    assert steady < 0.0
    assert 0.5 * sum(halves) * steady**2 == pytest.approx(p_chamber - p_port, rel=1e-12)
    assert halves[0] == line_restriction.resistance(hose, 1.5e-6, p_port, 293.0, p_chamber, 293.0, K, R)
