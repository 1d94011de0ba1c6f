"""Ideal devices for one joint: what they save is what their share of the joint's moment costs."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.simulation import ideal_devices
from exo_sim.simulation.summary import summarise
from exo_sim.simulation.walk import Request, rig_at_250_psi
from exo_sim.simulation.wearer_inverse_dynamics import Held
from exo_sim.simulation.wearer_load import with_payload
from exo_sim.simulation.worn import Simulation

PHASE = 2.0 * np.pi * np.arange(400) / 400


def body(moments: np.ndarray, rates: np.ndarray) -> Held:
    return cast(Held, cast(Any, SimpleNamespace(moments=moments, rates=rates, sole_powers=np.zeros((len(moments), 2)))))


def test_a_device_takes_the_moment_of_its_direction_and_nothing_else() -> None:
    moments, rates = np.zeros((400, 6)), np.ones((400, 6))
    moments[:, 0] = moments[:, 3] = 50.0 * np.sin(PHASE)  # flexes for half of the cycle, with a joint that flexes
    whole = ideal_devices.cost(moments * rates, np.zeros((400, 2)), 75.0)
    found = {(one.joint, one.direction): one for one in ideal_devices.devices(body(moments, rates), 75.0)}
    gives = 2 * 50.0 / np.pi  # of both legs, over the cycle
    saved = {key: whole.high - one.cost.high for key, one in found.items()}
    assert saved["hip", "flexion"] == pytest.approx(gives / 0.25, rel=1e-3)
    assert saved["hip", "extension"] == pytest.approx(gives / 1.20, rel=1e-3)
    assert found["hip", "flexion"].torque == pytest.approx(50.0) and found["hip", "flexion"].power == pytest.approx(100.0)
    assert found["hip", "extension"].power == pytest.approx(0.0, abs=1e-9)  # it only brakes
    assert all(saved[key] == pytest.approx(0.0, abs=1e-9) for key in saved if key[0] != "hip")


def test_a_backpack_of_38_kg_costs_what_the_ledger_says_and_devices_save_it_joint_by_joint() -> None:
    walk = Simulation(rigs.read(rig_at_250_psi()), Request("level_walk", 38.0, cycles=2, law="inverse_dynamics")).run()
    pack, mass = with_payload(walk, 38.0), walk.person.mass
    whole = ideal_devices.cost(pack.powers, pack.sole_powers, mass)
    assert whole.value == pytest.approx(summarise(walk)["compared_with"]["backpack"]["metabolic_w"], rel=1e-9)
    found = ideal_devices.devices(pack, mass)
    saved = [whole.value - one.cost.value for one in found]
    assert len(found) == 6 and min(saved) >= 0.0
    nothing = ideal_devices.cost(np.zeros_like(pack.powers), pack.sole_powers, mass)
    assert sum(saved) == pytest.approx(whole.value - nothing.value, rel=1e-9)
