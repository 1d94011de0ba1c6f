"""Walks that the controller was not told of: the demand of the undisturbed one, and what is different."""

import numpy as np
import pytest

from exo_sim.machine.worn_model import PAYLOAD_LIMIT
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation
from exo_sim.sizing.disturbances import DISTURBANCES, disturbances_of, disturbed
from exo_sim.sizing.loads import Condition


def test_who_does_not_walk_is_not_disturbed_and_nobody_carries_more_than_the_frame_does():
    assert disturbances_of(Condition("squat", 20.0)) == ()
    assert disturbances_of(Condition("level_walk", 34.0)) == DISTURBANCES
    heavy = disturbances_of(Condition("level_walk", PAYLOAD_LIMIT))
    assert len(heavy) == len(DISTURBANCES) - 1 and all(one.payload == 0.0 for one in heavy)


def test_each_walk_has_the_demand_of_the_undisturbed_one(exo, condition):
    nominal = Simulation(exo, Request("level_walk", 34.0, 1.0, 2, law="inverse_dynamics"))
    mass, count = nominal.model.body_mass.sum(), len(nominal.demand) - 1
    found = {one.name: (one, other) for one, other in disturbed(nominal, exo, condition)}
    assert found.keys() == {one.name for one in DISTURBANCES}
    for one, other in found.values():
        assert other.model.body_mass.sum() == pytest.approx(mass + one.payload)
        assert other.straps.stiffness == pytest.approx(one.stiffness * nominal.straps.stiffness)
        if other.motion.trial is None:
            assert np.roll(other.demand[:-1], -round(one.late * count), axis=0) == pytest.approx(nominal.demand[:-1])
    hips = found["hips 3 degrees more flexed"][1].motion.position[:, 3] - nominal.motion.position[:, 3]
    assert np.degrees(hips.mean()) == pytest.approx(3.0, abs=0.3)
    assert found["stride time varies by 2 %"][1].motion.trial is not None
