"""Where the plan's torques cannot be held (an ankle that has neither spring nor actuator), and a plan that is played later."""

import dataclasses

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.control import machine_dynamics
from exo_sim.rig import Ankle
from exo_sim.simulation.rehearsal import Rehearsals
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request, Walk, rig_at_250_psi
from exo_sim.simulation.worn import Simulation


@pytest.mark.parametrize(("mode", "watts", "push"), [("free", 700.0, 70.0), ("powered", 480.0, 20.0)])
def test_an_ankle_without_a_spring_is_gone_on_with_from_the_better_of_two_starts(mode: str, watts: float, push: float) -> None:
    """From the plan alone the free ankle cost 902 W with hips of 77 N m, and the powered one pushed its wearer with 36 N."""
    rig = dataclasses.replace(rigs.read(rig_at_250_psi()), ankle=Ankle(mode))
    wearer = summarise(Simulation(rig, Request("level_walk", 34.0, cycles=5)).run())["wearer"]
    assert wearer["metabolic_w"]["value"] < watts and abs(wearer["forward_push_n"]) < push
    assert wearer["moment_rms_nm"]["hip"] < 40.0


def test_inverse_dynamics_is_rehearsed_before_the_plan_where_there_are_two_rehearsals_and_not_where_there_are_fewer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rig = dataclasses.replace(rigs.read(rig_at_250_psi()), ankle=Ankle("free"))
    once, tried = Rehearsals.learn_from, []

    def watched(it: Rehearsals, walk: Walk) -> float:
        torque = it.plan.torque()
        tried.append(np.concatenate([torque, torque[:1]]))
        return once(it, walk)

    def walked(rehearsals: int) -> tuple[np.ndarray, list[np.ndarray]]:
        tried.clear()
        return Simulation(rig, Request("level_walk", 34.0, cycles=1, rehearsals=rehearsals)).demand, tried.copy()

    monkeypatch.setattr(Rehearsals, "learn_from", watched)
    plan, none = walked(0)
    assert not none
    after_one, (first,) = walked(1)
    np.testing.assert_array_equal(first, plan)
    np.testing.assert_array_equal(after_one, plan)
    _, (before, then) = walked(2)
    np.testing.assert_array_equal(then, plan)
    needed = Simulation(rig, Request("level_walk", 34.0, cycles=1, law="inverse_dynamics")).demand
    near, far = (np.sqrt(np.mean((one - needed) ** 2)) for one in (before, plan))
    assert near < 0.2 * far


def test_a_plan_played_later_has_the_torques_of_the_phases_before() -> None:
    plan = Simulation(rigs.read(rig_at_250_psi()), Request("level_walk", 20.0, cycles=3, rehearsals=0, law="causal"))
    assert plan.calibration is not None
    it = plan.calibration.plan
    table, late = it.torque(best=True), it.later(8 / 512).torque(best=True)
    assert np.abs(late - np.roll(table, 8, axis=0)).max() < 0.1 * np.abs(table).max()
    np.testing.assert_array_equal(it.torque(best=True), table)


def test_what_pushes_a_newton_more_loads_the_joints_less_than_a_constant_torque_that_does() -> None:
    simulation = Simulation(rigs.read(rig_at_250_psi()), Request("level_walk", 20.0, cycles=3, rehearsals=0, law="causal"))
    assert simulation.calibration is not None
    it = simulation.calibration.plan
    torques = it.table(it.pushing())[machine_dynamics.PICK][:, it.driven]
    forces = it.strap_forces(torques)
    assert it.push(forces) == pytest.approx(1.0)
    steady = np.zeros_like(torques)
    steady[:, [0, 2]] = 1.0 / it.push(it.strap_forces(np.tile([1.0, 0.0, 1.0, 0.0], (len(torques), 1))))
    loads = [np.linalg.norm(np.einsum("nij,nj->ni", it.yielding.load, one)) for one in (forces, it.strap_forces(steady))]
    assert loads[0] < loads[1]
