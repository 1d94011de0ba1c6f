"""Known limits of line restriction: closed forms and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from physics.air import PA, K
from physics.stepping import hold, tank

from exo_sim.physics import nozzle, state
from exo_sim.physics.effects import line_restriction
from exo_sim.physics.pneumatics import paper_cylinder


def test_a_hose_of_a_low_ratio_passes_the_ellipse() -> None:
    """ISO 6358 at 0.8 with b = 0.3: sqrt(1 - (0.5/0.7)^2) of choked flow; choked flow is the nozzle's."""
    hose = paper_cylinder(0.032, 0.012, 0.1, 5e-6)["line_restriction"][0].copy()
    hose["ratio"] = 0.3
    choked = nozzle.flow(1e-6, 5e5, 293.0, 1e5, 293.0, K, 287.05)
    assert line_restriction.flow(hose, 1e-6, 5e5, 293.0, 1e5, 293.0, K, 287.05) == pytest.approx(choked, rel=1e-12)
    expected = choked * math.sqrt(1.0 - (0.5 / 0.7) ** 2)
    assert line_restriction.flow(hose, 1e-6, 5e5, 293.0, 4e5, 293.0, K, 287.05) == pytest.approx(expected, rel=1e-12)
    assert line_restriction.flow(hose, 1e-6, 4e5, 293.0, 5e5, 293.0, K, 287.05) == pytest.approx(-expected, rel=1e-12)


def test_hose_lies_between_valve_and_chamber() -> None:
    gas = tank(1.0, 2e-6, dt=1e-3)
    gas.cylinders["line_restriction"]["area"], gas.cylinders["line_restriction"]["volume"] = 2e-6, 1e-5
    gas.fill(np.zeros(1), PA, PA)
    hold(gas, 1.0, 0.3)
    node = (K - 1) * gas.integrated[0, state.HOSE_ENERGY_1] / 1e-5
    assert node == pytest.approx(565220.8, rel=1e-3)  # the chamber behind has risen by 0.1 % meanwhile
    assert gas.books().mass_residual < 1e-10


def test_wide_hose_only_adds_its_volume() -> None:
    gas, paper = tank(5e-5, 1e-6, dt=1e-3), tank(6e-5, 1e-6, dt=1e-3)
    gas.cylinders["line_restriction"]["area"], gas.cylinders["line_restriction"]["volume"] = 1e-3, 1e-5
    for each in (gas, paper):
        each.fill(np.zeros(1), 2e5, 2e5)
        hold(each, 1.0, 0.05)
    assert gas.pressures(np.zeros(1)) == pytest.approx(paper.pressures(np.zeros(1)), rel=1e-4)


def test_the_critical_ratio_of_a_hose_in_the_units_that_the_effect_names() -> None:
    """b = 474 C/D^2 with C = 0.029 D^2/sqrt(L/D^1.25 + 510), all in SI, of hoses of 3 to 8 mm and 0.3 to 2 m."""
    ratios = [474.0 * 0.029 / math.sqrt(length / bore**1.25 + 510.0) for bore in (0.003, 0.008) for length in (0.3, 2.0)]
    (said,) = [one.source for one in line_restriction.EFFECT.parameters if one.name == "ratio"]
    assert f"C in m^3/(s Pa), D in m): {min(ratios):.2f}-{max(ratios):.2f}" in said
