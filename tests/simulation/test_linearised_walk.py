"""What straps do for a little more torque, worked out along a walk and walked."""

from pathlib import Path

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.control.causal import strap_forces
from exo_sim.control.machine_dynamics import PHASES
from exo_sim.simulation.linearised_walk import BOUNCES, landings, linearised
from exo_sim.simulation.rehearsal import cycle_mean
from exo_sim.simulation.walk import Request, Walk
from exo_sim.simulation.worn import Simulation

SETTLING, DRIVEN, MORE = 2, [0, 1, 3, 4], 1.0  # by half as much a heel that hovers touches now and then


@pytest.fixture(scope="module")
def simulation(repository: Path) -> Simulation:
    """The walk that rehearsals end with: one that does not come again alike, as after few of them, has no steady answer."""
    return Simulation(rigs.read(repository / "assets" / "exo.toml"), Request("level_walk", 34.0, cycles=4))


def forces(walk: Walk) -> np.ndarray:
    return cycle_mean(walk, np.moveaxis(strap_forces(walk.columns, walk.straps), -1, 0), SETTLING)


@pytest.mark.parametrize(("joint", "harmonic"), [(0, 0), (0, 2), (1, 0), (1, 3)])
def test_straps_answer_to_torques_as_worked_out_along_the_walk(simulation: Simulation, joint: int, harmonic: int) -> None:
    """Both legs alike, half a cycle apart. Without the moment at which a foot meets the ground the error is 0.4 of the answer."""
    usual, n = simulation.demand, len(simulation.demand) - 1
    simulation.reset()
    along = linearised(simulation.run(), DRIVEN)
    wave = np.cos(2.0 * np.pi * harmonic * np.arange(n + 1) / n)
    other = np.cos(2.0 * np.pi * harmonic * (np.arange(n + 1) / n + 0.5))
    seen = []
    try:
        for sign in (1.0, -1.0):
            asked = usual.copy()
            asked[:, joint] += sign * MORE * wave
            asked[:, joint + 3] += sign * MORE * other
            simulation.demand = simulation.demand_added = asked
            simulation.reset()
            seen.append(forces(simulation.run()))
    finally:
        simulation.demand = simulation.demand_added = usual
    walked = (seen[0] - seen[1]) / (2.0 * MORE)
    basis = np.stack([np.cos(2.0 * np.pi * harmonic * (along.phase + shift)) for shift in (0.0, 0.5)], axis=1)
    answer = along.steady(basis, PHASES)
    places = (2 * DRIVEN.index(joint), 2 * DRIVEN.index(joint + 3) + 1)
    worked_out = answer[:, :, places[0]] + answer[:, :, places[1]]
    assert np.linalg.norm(walked - worked_out) < 0.25 * np.linalg.norm(walked)
    assert np.corrcoef(walked.reshape(-1), worked_out.reshape(-1))[0, 1] > 0.97


def test_a_step_taken_again_ends_where_the_walk_went_on(simulation: Simulation) -> None:
    """A change of the state at one step moves the walk on as steps one after the other say, while no foot comes down or leaves."""
    simulation.reset()
    walk = simulation.run()
    along = linearised(walk, DRIVEN)
    assert along.by_state.shape == (len(along.phase), 18, 18)
    assert np.isfinite(along.by_state).all() and np.isfinite(along.straps).all()
    whole = np.eye(18)
    for one in along.by_state:
        whole = one @ whole
    assert np.abs(np.linalg.eigvals(whole)).max() < 0.5  # straps hold the machine: what pushes it is gone a stride later


def test_a_foot_lands_once_however_often_it_bounces() -> None:
    """Columns: it comes down once; it bounces before it rests; it is off the ground for as long as a step. The cycle's end is its start."""
    step, gap = 1e-3, round(BOUNCES / 1e-3)
    touched = np.zeros((200, 3), dtype=bool)
    touched[100:, 0] = True
    touched[[100, 103, 110, 111], 1] = touched[115:, 1] = True
    touched[:100, 2] = touched[100 + gap + 1 :, 2] = True
    assert [np.nonzero(column)[0].tolist() for column in landings(touched, step).T] == [[100], [100], [100 + gap + 1]]


def test_no_bounce_doubles_the_answer_of_a_walk_that_stands_at_both_ends(repository: Path) -> None:
    """With bounces as landings states a step apart grow 1e9 times within 0.1 s."""
    rig = rigs.read(repository / "assets" / "exo.toml")
    walk = Simulation(rig, Request("start_and_stop", 34.0, cycles=1, rehearsals=0)).run()
    steps = linearised(walk, DRIVEN).by_state
    for first in range(0, len(steps) - 100, 100):
        along = np.eye(18)
        for one in steps[first : first + 100]:
            along = one @ along
        assert np.linalg.norm(along, 2) < 1e5
