"""The gas of a walk in a designer's numbers, against the same numbers by another way."""

import re

import numpy as np
import pytest
from simulation.walked import simulate

from exo_sim import rig as rigs
from exo_sim.rig.valve import with_edges, with_tank
from exo_sim.simulation.gas_use import dryness
from exo_sim.simulation.summary import Summary, span, summarise
from exo_sim.simulation.walk import Request, rig_at_250_psi


@pytest.fixture(scope="module")
def walked():
    return simulate(rigs.read(rig_at_250_psi()), Request("level_walk", cycles=4, law="inverse_dynamics"))


def test_the_gas_of_the_ledger_is_that_of_the_cylinders(walked):
    found = summarise(walked)
    gas, supply = found["gas"], walked.rig.supply.pressure
    assert gas["mass_kg_per_stride"] == pytest.approx(sum(one["gas_kg_per_stride"] for one in found["cylinders"].values()), rel=1e-9)
    assert gas["free_air_l_per_min"] == pytest.approx(gas["mass_kg_per_stride"] / walked.motion.period / 1.185 * 6e4)
    assert gas["exergy_w"] == pytest.approx(gas["mass_kg_per_s"] * 287.05 * 293.15 * np.log(supply / 101325.0))
    assert gas["least_kg_per_stride"] == pytest.approx(gas["efficiency"] * gas["mass_kg_per_stride"])  # what it would be without loss
    assert gas["peak_flow_l_per_min"] > gas["free_air_l_per_min"]
    assert gas["bottle"]["lasts_s"] == pytest.approx(0.602 / gas["mass_kg_per_s"], rel=0.01)


def test_rod_work_is_what_the_gas_did_on_the_pistons(walked):
    """The books integrate pressure over volume within each step; force times speed of the log must agree, atmosphere on the rod aside."""
    gas = summarise(walked)["gas"]
    part = {key: column[span(walked)] for key, column in walked.columns.items()}
    by_force = 0.0
    for name in walked.rig.cylinders:
        by_force += float(np.sum(0.5 * (part[f"{name}.force"][1:] + part[f"{name}.force"][:-1]) * np.diff(part[f"{name}.length"])))
    seconds = (len(part["gait.phase"]) - 1) * walked.step
    assert gas["positive_rod_work_w"] + gas["negative_rod_work_w"] == pytest.approx(by_force / seconds, rel=0.02, abs=0.5)
    assert 0.0 < gas["efficiency"] < 1.0


def test_cylinders_may_be_called_otherwise_than_their_joints(walked, tmp_path):
    text = rig_at_250_psi().read_text().replace('"exo.xml"', f'"{rig_at_250_psi().with_name("exo.xml")}"')
    (tmp_path / "rig.toml").write_text(re.sub(r"\[cylinders\.(hip|knee)_", r"[cylinders.\1_actuator_", text))
    own = simulate(rigs.read(tmp_path / "rig.toml"), walked.request)
    found, usual = summarise(own), summarise(walked)
    assert list(found["cylinders"]) == ["hip_actuator_l", "knee_actuator_l", "hip_actuator_r", "knee_actuator_r"]
    assert list(found["cylinders"].values()) == list(usual["cylinders"].values())
    assert {key: found[key] for key in ("gas", "ledger", "joints")} == {key: usual[key] for key in ("gas", "ledger", "joints")}


def test_pieces_say_what_the_whole_says(walked):
    from exo_sim.simulation.worn import Simulation

    whole, pieces = summarise(walked)["gas"], Summary()
    simulation = Simulation(walked.rig, Request("level_walk", cycles=7, law="inverse_dynamics"))
    for piece in simulation.pieces(most=1):
        pieces.add(piece)
    found = pieces.numbers()["gas"]
    for key in ("mass_kg_per_stride", "positive_rod_work_w", "peak_flow_l_per_min"):
        assert found[key] == pytest.approx(whole[key], rel=0.03)  # of seven strides, not of a few


def test_a_tank_saves_gas_at_the_same_torques_and_its_gain_is_taken_off():
    edges = with_edges(rigs.read(rig_at_250_psi()))
    request = Request("level_walk", cycles=4, law="inverse_dynamics")
    plain, tank = (simulate(rig, request) for rig in (edges, with_tank(edges, 2e-3)))
    without, found = summarise(plain), summarise(tank)
    gas, recovery = found["gas"], tank.rig.recovery
    assert recovery is not None
    assert gas["mass_kg_per_stride"] < 0.85 * without["gas"]["mass_kg_per_stride"]
    assert gas["recovery"]["pressure_least_pa"] > 0.85 * recovery.pressure
    assert gas["recovery"]["pressure_most_pa"] < 1.2 * recovery.pressure
    drawn = sum(one["gas_kg_per_stride"] for one in found["cylinders"].values())
    assert gas["mass_kg_per_stride"] == pytest.approx(drawn - gas["recovery"]["gain_kg_per_stride"])
    assert found["books"]["gas_mass_residual"] < 1e-12 and found["books"]["gas_energy_residual"] < 1e-12
    for joint in ("hip_r", "knee_r"):
        errors = [each["joints"][joint]["torque_error_rms_nm"] for each in (found, without)]
        assert errors[0] < errors[1] + 0.3


def test_how_dry_the_air_must_be_goes_by_the_coldest_gas():
    assert "class 4" in dryness(280.0) and "class 3" in dryness(255.0) and "class 1" in dryness(215.0)
    assert "colder than" in dryness(200.0)
