"""The actuators' own mass on the bodies: half at each end, no gram more, and the joints must carry it."""

import numpy as np
import pytest

from exo_sim.machine.rig_model import load
from exo_sim.sizing.loads import joint_loads
from exo_sim.sizing.own_mass import masses_of, with_masses
from exo_sim.sizing.screening import chosen_bores


def test_half_of_each_cylinder_hangs_at_each_of_its_ends(exo, condition, loads, space):
    design = space.design(space.owners(exo), chosen_bores(exo, space, (loads,), space.owners(exo)))
    masses = masses_of(space, design)
    assert masses.keys() == exo.cylinders.keys()
    heavy = with_masses(exo, masses)
    plain, model = load(exo), load(heavy)
    grown = {model.body(i).name: float(model.body_mass[i] - plain.body_mass[i]) for i in range(model.nbody)}
    assert sum(grown.values()) == pytest.approx(sum(masses.values()))
    assert grown["torso"] == pytest.approx(0.5 * (masses["hip_l"] + masses["hip_r"]))
    assert grown["thigh_l"] == pytest.approx(0.5 * (masses["hip_l"] + masses["knee_l"]))
    assert grown["shank_l"] == pytest.approx(0.5 * masses["knee_l"])
    assert grown["foot_l"] == 0.0
    tank = load(with_masses(exo, masses, tank=0.6))
    assert tank.body("torso").mass[0] - model.body("torso").mass[0] == pytest.approx(0.6)
    assert tank.body_mass.sum() - model.body_mass.sum() == pytest.approx(0.6)
    own = joint_loads(heavy, condition)
    assert own.mass == pytest.approx(loads.mass + sum(masses.values()))
    assert np.abs(own.torque).max() > np.abs(loads.torque).max()
