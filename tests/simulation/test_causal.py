"""A controller that knows only what the machine measures: relief where the rehearsed demand has it, and where that loses it."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.control import causal
from exo_sim.control.causal import Calibration, Causal
from exo_sim.gait.variation import Variation
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request, Walk
from exo_sim.simulation.worn import Simulation

STRIDES = 9


@pytest.fixture(scope="module")
def exo(repository):
    return rigs.read(repository / "assets" / "exo.toml")


@pytest.fixture(scope="module")
def calibration(exo):
    simulation = Simulation(exo, Request("level_walk", cycles=4, law="causal"))
    assert simulation.calibration is not None
    return simulation.calibration


def walked(
    exo: Any, calibration: Calibration | None, stiffness: float = 1.0, controller: dict[str, Any] | None = None, **asked: Any
) -> Walk:
    """Walk with the causal controller as calibrated on the nominal stride."""
    asked = {"rehearsals": 0, "law": "inverse_dynamics", **asked}
    simulation = Simulation(exo, Request("level_walk", cycles=STRIDES, **asked))
    straps = simulation.straps
    simulation.straps = dataclasses.replace(straps, stiffness=stiffness * straps.stiffness, damping=stiffness**0.5 * straps.damping)
    if calibration is not None:
        simulation.controlled_by(Causal(calibration, **(controller or {})), seed=1)
    return simulation.run()


def costs(walk):
    summary = summarise(walk)
    return summary["wearer"]["metabolic_w"]["value"], summary["compared_with"]["backpack"]["metabolic_w"], summary


CASES: dict[str, dict[str, Any]] = {
    "nominal": {},
    "begins at the wrong phase": {"controller": {"first_phase": 0.05}},
    "encoders' phase is late throughout": {"controller": {"late": 0.03}},
    "encoders' phase is early throughout": {"controller": {"late": -0.03}},
    "faster": {"speed": 1.1},
    "straps half as stiff": {"stiffness": 0.5},
    "straps twice as stiff": {"stiffness": 2.0},
    "four kilograms more": {"payload": 38.0},
    "strides vary": {"variation": Variation(stride_time=0.02, seed=1)},
}


@pytest.mark.parametrize("name", CASES)
def test_it_relieves_the_wearer_where_nothing_was_rehearsed(exo, calibration, name):
    machine, backpack, summary = costs(walked(exo, calibration, **CASES[name]))
    assert machine < backpack
    assert abs(summary["wearer"]["forward_push_n"]) < 20.0  # asked; on straps half as stiff it was 31 N before the push was taken back
    assert abs(summary["ledger"]["closure"]) < 1.5


def test_the_same_seed_gives_the_same_walk_and_another_seed_other_noise(exo, calibration):
    walks = []
    for seed in (1, 1, 2):
        simulation = Simulation(exo, Request("level_walk", cycles=1, rehearsals=0, law="inverse_dynamics"))
        simulation.controlled_by(Causal(calibration), seed=seed)
        walks.append(simulation.run().columns["hip_l.torque_demanded"])
    np.testing.assert_array_equal(walks[0], walks[1])
    assert np.abs(walks[0] - walks[2]).max() > 1e-3


def test_it_sees_nothing_but_encoders_inertial_unit_and_load_cells(exo, calibration):
    """Whatever else is observed may be anything."""
    seen = set()

    class Watched(dict[str, float]):
        def __getitem__(self, key: str) -> float:
            seen.add(key)
            return 0.0

    controller = Causal(calibration)
    simulation = Simulation(exo, Request("level_walk", cycles=1, rehearsals=0, law="inverse_dynamics"))
    simulation.controlled_by(controller)
    assert simulation._asked is not None
    controller.reset(simulation._asked.context)
    controller.act(Watched())
    parts = [key.split(".") for key in seen - {"time"}]
    assert {signal for _, signal in parts} == {"position", "strap_force_x", "strap_force_z"}
    joints = {f"{joint}_{side}" for joint in ("hip", "knee", "ankle") for side in "lr"}
    assert {part for part, signal in parts if signal == "position"} == {"torso_pitch", *joints}


def test_it_asks_for_what_was_calibrated_where_straps_show_what_belongs_to_the_phase(exo, calibration, monkeypatch):
    """Without noise and at the calibration's own phases and forces, the torque is that of the plan."""
    steps = 640
    grid = np.arange(steps + 1) / steps

    def shown(table, k):
        closed = np.concatenate([table, table[:1]])
        at = np.arange(len(closed)) / len(table)
        return np.array([np.interp(grid[k % steps], at, column) for column in closed.T])

    monkeypatch.setattr(causal, "LOAD_CELL", 0.0)
    monkeypatch.setattr(causal, "ENCODER", 1e-9)
    controller = Causal(calibration, period=calibration.period / steps)
    simulation = Simulation(exo, Request("level_walk", cycles=1, rehearsals=0, law="inverse_dynamics"))
    simulation.controlled_by(controller)
    assert simulation._asked is not None
    context = dataclasses.replace(simulation._asked.context, period=calibration.period / steps, step=calibration.period / steps)
    controller.reset(context)
    table = calibration.plan.torque(best=True)
    for k in range(1, steps):
        monkeypatch.setattr(causal, "strap_forces", lambda observation, straps, k=k: shown(calibration.forces, k))
        encoders = dict(zip(("hip_l", "hip_r", "knee_l", "knee_r"), shown(calibration.encoders, k)))
        out = controller.act({"time": 10.0, **{f"{name}.position": value for name, value in encoders.items()}})
        wanted = [np.interp((k + 1) / steps, np.arange(513) / 512, np.append(column, column[0])) for column in table.T]
        assert np.abs(np.array(list(out.values())) - wanted).max() < 0.02 * np.abs(table).max()
