"""The state vector: every number has a place of its own, and the parts follow each other without a gap."""

from __future__ import annotations

import numpy as np
import pytest
from physics.stepping import bench

from exo_sim.physics import state


@pytest.mark.parametrize(
    ("names", "size"),
    [
        ("MASS_1 ENERGY_1 MASS_2 ENERGY_2 HOSE_MASS_1 HOSE_ENERGY_1 HOSE_MASS_2 HOSE_ENERGY_2 MIDDLE_MASS_1 MIDDLE_ENERGY_1 "
         "MIDDLE_MASS_2 MIDDLE_ENERGY_2 WALL_1 WALL_2 HOSE_FLOW_1 MIDDLE_FLOW_1 HOSE_FLOW_2 MIDDLE_FLOW_2 DRAWN EXHAUSTED LEAKED "
         "DRAWN_ENTHALPY EXHAUSTED_ENTHALPY LEAKED_ENTHALPY HEAT WORK", state.INTEGRATED),
        ("SUPPLY_MASS SUPPLY_ENERGY EXHAUST_MASS EXHAUST_ENERGY TANK_MASS TANK_ENERGY FED FED_ENTHALPY RELEASED RELEASED_ENTHALPY",
         state.SHARED),
        ("SPOOL BRISTLE PISTON PISTON_SPEED SPOOL_2 TANK_SPOOL_1 TANK_SPOOL_2 SPOOL_SPEED "
         "SPOOL_SPEED_2 TANK_SPOOL_SPEED_1 TANK_SPOOL_SPEED_2", state.REMEMBERED),
        ("FELT HELD FASTER", state.SHARED_REMEMBERED),
    ],
)  # fmt: skip
def test_each_number_has_one_place(names: str, size: int) -> None:
    assert sorted(getattr(state, name) for name in names.split()) == list(range(size))


def test_views_of_a_machine_cover_its_vector() -> None:
    gas = bench()
    assert gas.vector.size == state.size(1, 0) == state.integrated_size(1) + state.REMEMBERED + state.SHARED_REMEMBERED
    assert gas.integrated.shape == (1, state.INTEGRATED) and np.shares_memory(gas.integrated, gas.vector)
    assert gas.memory.shape == (1, state.REMEMBERED) and np.shares_memory(gas.memory, gas.vector)
