"""Regimes of a chamber: they follow from command, pressure ratio and speed, and the exclusive ones cover the time."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis.cylinder_runs import run_of

from exo_sim.diagnosis.policy.regimes import CLOSED
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs, inputs
from exo_sim.diagnosis.subsystems.gas.regimes import regimes
from exo_sim.physics.plant_records import WORLD

K = 1.4
CRITICAL = 0.5283  # (2 / (k + 1))^(k / (k - 1)) for k = 1.4
SUPPLY, EXHAUST = 8e5, 1e5


def gas(pressure: list[float], command: list[float], speed: list[float]) -> GasInputs:
    world = np.zeros(1, WORLD)
    world["supply_pressure"], world["exhaust_pressure"] = SUPPLY, EXHAUST
    run = run_of(np.array(pressure), np.array(pressure), command=np.array(command), speed=np.array(speed))
    return inputs(run, world, 10.0)


@pytest.mark.parametrize(("pressure", "command", "names"), [
    (0.9 * CRITICAL * SUPPLY, 1.0, {"filling", "filling, choked"}),
    (1.1 * CRITICAL * SUPPLY, 1.0, {"filling", "filling, subsonic"}),
    (1.1 * SUPPLY, 1.0, {"filling", "chamber above supply"}),
    (1.1 * EXHAUST / CRITICAL, -1.0, {"venting", "venting, choked"}),
    (0.9 * EXHAUST / CRITICAL, -1.0, {"venting", "venting, subsonic"}),
    (3e5, 0.5 * CLOSED, {"valve closed", "valve closed, piston at rest", "small commands"}),
])  # fmt: skip
def test_what_the_valve_does(pressure: float, command: float, names: set[str]) -> None:
    given = gas([pressure] * 6, [command] * 6, [0.0] * 6)
    assert {name for name, holds in regimes(given, 0, K).items() if holds[0]} == names | {"piston at rest"}


def test_the_second_chamber_vents_where_the_first_is_filled() -> None:
    given = gas([3e5] * 6, [1.0] * 6, [0.0] * 6)
    assert regimes(given, 0, K)["filling"].all() and regimes(given, 1, K)["venting"].all()


def test_every_sample_is_in_one_regime_of_the_valve_and_one_of_the_piston() -> None:
    rng = np.random.default_rng(0)
    n = 500
    given = gas(list(rng.uniform(1e5, 9e5, n)), list(rng.uniform(-1, 1, n) * rng.integers(0, 2, n)), list(rng.normal(0.0, 0.02, n)))
    found = regimes(given, 0, K)
    np.testing.assert_array_equal(sum(found[key].astype(int) for key in ("filling", "venting", "valve closed")), np.ones(n))
    np.testing.assert_array_equal(found["piston moving"], ~found["piston at rest"])
    np.testing.assert_array_equal(
        found["filling"], found["filling, choked"] | found["filling, subsonic"] | found["chamber above supply"]
    )


def test_the_command_crosses_zero_where_its_sign_changes() -> None:
    command = [1.0] * 300 + [-1.0] * 300
    near = regimes(gas([3e5] * 600, command, [0.0] * 600), 0, K)["command near zero crossing"]
    assert near[290:340].all() and not near[:270].any() and not near[360:].any()
