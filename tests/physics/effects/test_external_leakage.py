"""Known limits of external leakage: closed forms and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from physics.air import PA, K, R
from physics.stepping import hold, tank

from exo_sim.physics import nozzle, state
from exo_sim.physics.conditions import Chamber
from exo_sim.physics.effects import external_leakage
from exo_sim.physics.pneumatics import paper_cylinder, paper_world


def test_empties_exponentially_in_501_seconds() -> None:
    """C = 1e-12 m^3/(s Pa) on 50 cm^3 at 6 bar (B3): 501 s, 1197 Pa/s, 2.16 dm^3/h of free air."""
    area = 1e-12 * 5.020208972e-6 / 1e-8
    gas = tank(5e-5, 5e-6, dt=5e-3)
    gas.cylinders["external_leakage"]["area_1"] = area
    gas.cylinders["wall_heat_transfer"]["conductance"] = 100.0
    gas.fill(np.zeros(1), 6e5, 6e5)
    flow = nozzle.mass_flow(area, 6e5, 293.15, PA, K, R)
    tau = gas.integrated[0, state.MASS_1] / flow
    assert tau == pytest.approx(501.4, abs=0.1)
    assert 6e5 / tau == pytest.approx(1197.0, abs=0.5)
    assert flow / 1.185 * 3.6e6 == pytest.approx(2.160, abs=2e-3)
    hold(gas, 0.0, 10.0)
    assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(6e5 * math.exp(-10.0 / tau), rel=5e-6)
    assert gas.pressures(np.zeros(1))[0, 1] == 6e5


def test_porous_path_obeys_its_law_in_both_directions() -> None:
    p, world = paper_cylinder(0.032, 0.012, 0.1, 5e-6)["external_leakage"][0], paper_world()[0]
    p["laminar_1"], p["inertial"] = 2.3e-17, 4e18
    for pressure in (8.6e5, 3e5, 1.02e5, 5e4):
        here = Chamber(1, pressure, 293.15, 1e-4, 293.15, 8e-4, 0.05, 0.0, 0.05, 0.0, 8e-4, 0.1)
        w = external_leakage.outward(p, here, here, world)
        assert w / 2.3e-17 + 4e18 * w * abs(w) == pytest.approx(pressure**2 - PA**2, rel=1e-12)
        assert external_leakage.outward(p, here._replace(side=2), here, world) == 0.0


@pytest.mark.parametrize("b", [0.2, 0.45])
def test_an_orifice_with_a_ratio_of_its_own_follows_iso_6358(b: float) -> None:
    """Choked it passes what a nozzle does; above its ratio the ellipse (ISO 6358:1989, eq. 3)."""
    p, world = paper_cylinder(0.032, 0.012, 0.1, 5e-6)["external_leakage"][0], paper_world()[0]
    p["area_1"], p["ratio"] = 3e-8, b
    for pressure in (0.9 * PA / b, PA / b, 2.0 * PA, 1.3 * PA, 1.05 * PA):
        here = Chamber(1, pressure, 293.15, 1e-4, 293.15, 8e-4, 0.05, 0.0, 0.05, 0.0, 8e-4, 0.1)
        choked = 0.6847314563772704 * 3e-8 * pressure / math.sqrt(R * 293.15)  # sqrt(k) (2/(k + 1))^((k + 1)/(2 (k - 1))), k = 1.4
        beyond = max(PA / pressure - b, 0.0) / (1.0 - b)
        assert external_leakage.outward(p, here, here, world) == pytest.approx(choked * math.sqrt(1.0 - beyond**2), rel=1e-9)
