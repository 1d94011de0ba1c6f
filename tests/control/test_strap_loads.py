"""What a strap does to its wearer: as `ground_reaction.hold` has it, within the soles and at their edge."""

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.control import machine_dynamics
from exo_sim.control.machine_dynamics import PICK
from exo_sim.control.strap_loads import StrapLoads
from exo_sim.gait.moving_body import Moving, body_loads
from exo_sim.machine.ground_reaction import hold, joint_moments
from exo_sim.simulation.walk import Request, rig_at_250_psi
from exo_sim.simulation.worn import Simulation

#: A torso strap that pushes its wearer back by so much, in the midst of right stance [N].
MUCH = 250.0


@pytest.fixture(scope="module")
def worn() -> Simulation:
    return Simulation(rigs.read(rig_at_250_psi()), Request("level_walk", 34.0, rehearsals=0))


def felt(it: Simulation, across: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return joint moments, the residual moment, and whether soles can give no more, for the first torso strap's force across [N]."""
    poses, wrench = body_loads(Moving.of(it.motion, PICK), it.person)
    direction, anchor = along(it).strap_direction[:, 0], it.straps.anchor[0]
    force = -across * direction[:, 0]
    arm = anchor[0] * direction[:, 0] + anchor[1] * direction[:, 1]
    wrench[:, 0, :2] += force
    wrench[:, 0, 2] += arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
    motion = it.motion
    ground = hold(poses, wrench, motion.share[PICK], motion.pressure_centre[PICK], motion.support[PICK], it.person)
    return joint_moments(poses, wrench, ground.force, ground.place), ground.residual[:, 2], ground.outside


def along(it: Simulation) -> machine_dynamics.MachineDynamics:
    return machine_dynamics.along(it.model, it.motion, it.person, it.straps)


@pytest.mark.parametrize(("force", "edge"), [(0.0, False), (MUCH, True)])
def test_soles_give_what_a_strap_asks_until_the_pressure_is_at_their_edge(worn: Simulation, force: float, edge: bool) -> None:
    # the levers of a unit are those of the centre that is expected, not of the edge
    unit = StrapLoads.of(along(worn), worn.motion, worn.person, worn.straps).at(np.full(len(worn.motion.position[PICK]), float(edge)))
    (before, left, outside), (after, more, _) = felt(worn, force), felt(worn, force + 1.0)
    stands = slice(14, 22)  # of 64 phases, the right foot alone and flat
    assert (outside[stands] == edge).all()
    np.testing.assert_allclose((after - before)[stands, 3:], unit[stands, 3:6, 0], atol=0.05)
    np.testing.assert_allclose((more - left)[stands], unit[stands, 6, 0], atol=0.05)
