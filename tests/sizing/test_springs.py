"""A spring beside the rod: it pulls back, and a plan with it draws no more than one without."""

from dataclasses import replace

import numpy as np

from exo_sim.control.pressure_plan import STIFFEST, plan
from exo_sim.physics.pneumatics import paper_cylinder, paper_world
from exo_sim.sizing.screening import chosen_bores
from exo_sim.sizing.springs import beside

PHASE = np.arange(64) / 64


def test_a_load_that_a_spring_would_give_is_given_by_one():
    cylinder = paper_cylinder(0.050, 0.020, 0.150, 60e-6, 1e-3, 1e-3)[0]  # so much volume is no spring itself
    x = 0.08 + 0.03 * np.sin(2 * np.pi * PHASE)
    force = -8e3 * (x - 0.06)
    world = paper_world(11e5)[0]
    plain, sprung = (plan(world, cylinder, x, force, 1.0, spring) for spring in (False, True))
    assert plain.spring is None
    assert sprung.gas < 0.3 * plain.gas


def test_springs_of_a_design_pull_back_and_are_none_that_nobody_winds(exo, loads, space):
    edges = {name: replace(c, valve=replace(c.valve, independent=True)) for name, c in exo.cylinders.items()}
    machine = replace(exo, cylinders=edges)
    design = space.design(space.owners(machine), chosen_bores(machine, space, (loads,), space.owners(machine)))
    for stiffness, rest in beside(machine, space.kinds, loads, design).values():
        assert 0.0 < stiffness <= STIFFEST
        assert abs(rest) <= 0.41
