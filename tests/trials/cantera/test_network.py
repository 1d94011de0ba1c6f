"""Cylinders of Cantera's reactors: closed forms of gas dynamics, and files that mean what the contract says."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.cli import main
from exo_sim.errors import TrialError
from exo_sim.machine.rig_model import load
from exo_sim.trials.cantera.case import BLOCKS, CELLS, MAKE, choose, make_case
from exo_sim.trials.cantera.network import Cylinder
from exo_sim.trials.sealed_machines import plans_of
from exo_sim.trials.whole_machines.case import truth_of, write_case
from exo_sim.trials.whole_machines.machine import Machine

SHUT = {
    "area_1": 5e-4, "area_2": 4.5e-4, "stroke": 0.1, "dead_1": 5e-6, "dead_2": 5e-6, "piston_mass": 0.1, "inertia": 2.0, "supply": 6e5,
    "valve_area": 2e-6, "lap_s1": 0.1, "lap_e1": 0.1, "lap_s2": 0.1, "lap_e2": 0.1,
}  # fmt: skip
TIMES = np.arange(0.0, 0.25, 5e-4)


def swung(**numbers: float) -> tuple[Machine, dict[str, np.ndarray]]:
    """Return a piston with a shut valve, let go out of balance."""
    machine = Machine({**SHUT, **numbers})
    return machine, Cylinder(machine, lambda *_: 0.0, (0.05, 4.5e5, 3.5e5)).run(TIMES)


def test_shut_and_without_heat_gas_is_isentropic_and_no_energy_is_lost():
    m, log = swung()
    x = log["piston"]
    assert np.ptp(x) > 0.01
    for number, volume in ((1, m["dead_1"] + m["area_1"] * x), (2, m["dead_2"] + m["area_2"] * (m["stroke"] - x))):
        pressure, temperature = log[f"pressure_{number}"], log[f"temperature_{number}"]
        mass = pressure * volume / temperature
        assert np.ptp(mass) / mass[0] < 1e-5
        assert np.allclose(pressure * volume**1.4 / (pressure[0] * volume[0] ** 1.4), 1.0, atol=3e-3)  # k of real air falls a little
    work = m["area_1"] * log["pressure_1"] - m["area_2"] * log["pressure_2"] - m["ambient"] * (m["area_1"] - m["area_2"])
    done = np.concatenate([[0.0], np.cumsum(0.5 * (work[1:] + work[:-1]) * np.diff(x))])
    kinetic = 0.5 * m.moved_mass * log["piston_speed"] ** 2
    assert np.abs(done - kinetic).max() < 2e-3 * kinetic.max()


def test_coulomb_and_viscous_friction_take_the_energy_that_they_should():
    m, log = swung(coulomb=8.0, viscous=20.0, smooth_speed=1e-3)
    v = log["piston_speed"]
    lost = 8.0 * np.abs(np.tanh(v / 1e-3) * v) + 20.0 * v * v
    work = (log["gas_force"] * v) - lost
    done = np.concatenate([[0.0], np.cumsum(0.5 * (work[1:] + work[:-1]) * np.diff(TIMES))])
    kinetic = 0.5 * m.moved_mass * v**2
    assert np.abs(done - kinetic).max() < 1e-2 * kinetic.max()


def test_a_leak_across_the_piston_moves_what_the_nozzle_lets_through():
    m, log = swung(leak_piston=2e-7, inertia=500.0)  # a load that hardly moves
    volume = m["dead_1"] + m["area_1"] * log["piston"]
    mass = log["pressure_1"] * volume / (287.05 * log["temperature_1"])
    p1, p2, t1 = (float(log[name][0]) for name in ("pressure_1", "pressure_2", "temperature_1"))
    ratio = p2 / p1
    nozzle = np.sqrt(2 * 1.4 / 0.4 * (ratio ** (2 / 1.4) - ratio ** (2.4 / 1.4)))
    assert (mass[0] - mass[10]) / TIMES[10] == pytest.approx(2e-7 * p1 / np.sqrt(287.05 * t1) * nozzle, rel=0.02)


def test_what_is_hidden_and_what_is_known_never_meet():
    for seed in range(20):
        for cell, counts in zip(CELLS, ((1,), (2, 3, 4, 5, 6), (0,))):
            hidden, known = choose(cell, np.random.default_rng(seed))
            assert len(hidden) in counts and not set(hidden) & set(known) and set(hidden) | set(known) <= set(BLOCKS)
            assert len({"leak_piston", "leak_out"} & {*hidden, *known}) < 2


def test_cases_are_read_by_the_contract(tmp_path):
    case = make_case("x", seed=1, effects=("leak_piston",), duration=3.0)
    write_case(case, tmp_path / "one")
    write_case(make_case("x", seed=1, effects=("leak_piston",), duration=3.0), tmp_path / "two")
    for file in ("rig.toml", "recording.csv", "truth/fresh.csv"):
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()
    for file in ("rig.toml", "truth/nearest.toml"):
        machine = rigs.read(tmp_path / "one" / file)
        assert load(machine).nu == 1
        assert ("piston_leakage" in {effect.name for effect in machine.effects}) is (file != "rig.toml")
    truth = json.loads(json.dumps(truth_of(case)))
    assert truth["make"] == MAKE.name and truth["reported_only"] and [one["name"] for one in truth["hidden"]] == ["piston_leakage"]


def test_bad_wishes_are_named(monkeypatch, tmp_path, capsys):
    with pytest.raises(TrialError, match='no effect "leak"'):
        make_case("x", effects=["leak"])
    with pytest.raises(TrialError, match='no cell "outside"'):
        plans_of("cantera", 3, 1, None, "outside")
    with pytest.raises(TrialError, match="one make"):
        plans_of("cantera", 3, 1, "A", None)
    monkeypatch.setitem(sys.modules, "cantera", None)
    assert main(["trial", "make", "--truth", "cantera", "--cases", "2", "--out", str(tmp_path / "t")]) == 2
    assert "pip install" in capsys.readouterr().err and not (tmp_path / "t").exists()
