"""An ideal device takes what its joint gives in its direction, and nothing else; what it saves is what the ledger says."""

from pathlib import Path

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.errors import ScenarioError
from exo_sim.simulation import work_balance
from exo_sim.simulation.ideal_device import DEVICES, assisted
from exo_sim.simulation.walk import Request, Walk
from exo_sim.simulation.wearer_inverse_dynamics import Held
from exo_sim.simulation.wearer_load import with_payload
from exo_sim.simulation.worn import Simulation

LOAD = 38.0


@pytest.fixture(scope="module")
def walk(repository: Path) -> Walk:
    request = Request("level_walk", LOAD, cycles=1, law="inverse_dynamics")
    return Simulation(rigs.read(repository / "assets" / "exo.toml"), request).run()


@pytest.fixture(scope="module")
def loaded(walk: Walk) -> Held:
    return with_payload(walk, LOAD)


@pytest.mark.parametrize("device", DEVICES)
def test_device_and_wearer_give_together_what_he_gave_alone(loaded: Held, device: str) -> None:
    found, (joint, signs) = assisted(loaded, device), DEVICES[device]
    both = found.wearer.moments.copy()
    both[:, joint::3] += found.torque
    assert both == pytest.approx(loaded.moments, abs=1e-9)
    assert (found.power.sum(axis=1) + found.wearer.powers.sum(axis=1)) == pytest.approx(loaded.powers.sum(axis=1), abs=1e-9)
    if len(signs) == 1:
        assert np.all(signs[0] * found.torque >= 0.0) and np.all(signs[0] * found.wearer.moments[:, joint::3] <= 1e-12)
    else:
        assert np.abs(found.wearer.moments[:, joint::3]).max() < 1e-12
    others = [k for k in range(6) if k % 3 != joint]
    assert np.array_equal(found.wearer.moments[:, others], loaded.moments[:, others])


def test_none_costs_more_and_both_directions_save_what_each_does(walk: Walk, loaded: Held) -> None:
    cost = {name: work_balance.compared(assisted(loaded, name).wearer, walk)["metabolic_w"] for name in DEVICES}
    plain = work_balance.compared(loaded, walk)["metabolic_w"]
    assert max(cost.values()) <= plain
    swings = ("flexion", "extension")
    for joint, ways in (("hip", swings), ("knee", swings), ("ankle", ("plantarflexion", "dorsiflexion"))):
        each = sum(plain - cost[f"{joint} {way}"] for way in ways)
        assert plain - cost[f"{joint}, both ways"] == pytest.approx(each, abs=1e-6)


def test_a_device_that_is_none_is_refused(loaded: Held) -> None:
    with pytest.raises(ScenarioError, match="hip abduction"):
        assisted(loaded, "hip abduction")
