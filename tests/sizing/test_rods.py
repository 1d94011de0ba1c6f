"""Buckling and side load of rods, against closed forms and the walk itself."""

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.rig.catalogue import find
from exo_sim.simulation.walk import Request, rig_at_250_psi
from exo_sim.simulation.worn import Simulation
from exo_sim.sizing.rods import _rate, _side_load, rod_checks


@pytest.fixture(scope="module")
def walk():
    return Simulation(rigs.read(rig_at_250_psi()), Request("level_walk", 34.0, cycles=2, law="inverse_dynamics")).run()


def test_the_push_is_the_walks_and_the_buckling_load_euler_s(walk):
    found = {one.name: one for one in rod_checks(walk)}
    assert list(found) == list(walk.rig.cylinders)
    for name, one in found.items():
        assert one.push == pytest.approx(walk.columns[f"{name}.force"].max())
        entry = find(walk.rig.cylinders[name].bore, walk.rig.cylinders[name].rod)
        assert entry is not None
        assert one.buckling * one.push == pytest.approx(5.0 * entry.buckling_force(one.length))  # the catalogue's is five-fold safe
        assert one.side is not None and 0.0 < one.side < 20.0 * entry.mass(walk.rig.cylinders[name].stroke) * 9.81


def test_a_cylinder_that_lies_still_rests_half_its_weight_on_the_eye_and_none_when_it_hangs():
    still = np.zeros((64, 2, 3))
    still[:, 1, 0] = 0.4
    assert _side_load(still, 3.0, 1.0) == pytest.approx(0.5 * 3.0 * 9.81)
    still[:, 1] = [0.0, 0.0, -0.4]
    assert _side_load(still, 3.0, 1.0) == pytest.approx(0.0, abs=1e-9)


def test_a_cylinder_that_swings_needs_its_inertia_turned():
    angle = -0.5 * np.pi + 0.2 * np.sin(2 * np.pi * np.arange(256) / 256)
    ends = np.zeros((256, 2, 3))
    ends[:, 1, 0], ends[:, 1, 2] = 0.4 * np.cos(angle), 0.4 * np.sin(angle)
    turning, weight = (2 * np.pi / 0.2) ** 2 * 0.2 * 3.0 * 0.4 / 3.0, 0.5 * 3.0 * 9.81 * np.sin(0.2)
    assert _side_load(ends, 3.0, 0.2) == pytest.approx(turning - weight, rel=0.01)


def test_rates_of_harmonics_are_exact():
    t = np.arange(40) / 40 * 0.8
    assert _rate(np.sin(2 * np.pi * 3 * t / 0.8), 0.8) == pytest.approx(2 * np.pi * 3 / 0.8 * np.cos(2 * np.pi * 3 * t / 0.8))
