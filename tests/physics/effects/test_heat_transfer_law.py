"""Known limits of the law of heat transfer: one coefficient over the exposed wall, and Eichelberg's."""

from __future__ import annotations

import math
from pathlib import Path

import benches
import numpy as np
import pytest
from physics.air import CV, R
from physics.stepping import bench, drive, hold

from exo_sim.physics import state
from exo_sim.physics.effects.heat_transfer_law import FASTEST, SPEED
from exo_sim.rig import parse

CONDUCTANCE = 0.8


def cooled(x: float, pressure: float, exposure: float, exponent: float, stirring: float = 0.0) -> float:
    """Return the conductance by which a chamber's gas, a little warmer than its wall, cools at constant volume [W/K]."""
    gas = bench()
    gas.cylinders["wall_heat_transfer"]["conductance"] = CONDUCTANCE
    law = gas.cylinders["heat_transfer_law"]
    law["exposure"], law["exponent"], law["stirring"] = exposure, exponent, stirring
    gas.fill(np.full(1, x), pressure, pressure, temperature=293.25)
    mass = gas.integrated[0, state.MASS_1]
    left = (drive(gas, np.full(101, x))[-1, 2] - 293.15) / 0.1
    return -math.log(left) * mass * CV / (100 * gas.dt)


@pytest.mark.parametrize("x", [0.02, 0.05, 0.09])
def test_one_coefficient_acts_over_both_faces_and_the_barrel(x: float) -> None:
    faces, barrel = math.pi / 2 * 0.032**2, math.pi * 0.032
    coefficient = CONDUCTANCE / (faces + barrel * 0.05)
    assert cooled(x, 6e5, 1.0, 0.0) == pytest.approx(coefficient * (faces + barrel * x), rel=1e-4)
    half_way = 0.5 * (CONDUCTANCE + coefficient * (faces + barrel * x))
    assert cooled(x, 6e5, 0.5, 0.0) == pytest.approx(half_way, rel=1e-4)


def test_eichelberg_grows_with_the_root_of_pressure() -> None:
    assert cooled(0.05, 4e5, 1.0, 0.5) == pytest.approx(CONDUCTANCE, rel=1e-3)
    assert cooled(0.05, 6.4e5, 1.0, 0.5) / cooled(0.05, 1.6e5, 1.0, 0.5) == pytest.approx(2.0, rel=1e-4)


def test_nil_is_one_conductance_at_any_place_and_pressure() -> None:
    assert cooled(0.09, 2e5, 0.0, 0.0) == pytest.approx(CONDUCTANCE, rel=1e-4)


def test_it_stays_stable_where_the_law_makes_heat_fast() -> None:
    """Nearly all of the temperature is taken within one step: no overshoot past the wall's."""
    gas = bench()
    gas.cylinders["wall_heat_transfer"]["conductance"] = 60.0
    gas.cylinders["heat_transfer_law"]["exponent"] = 1.0
    gas.fill(np.full(1, 0.002), 9e5, 9e5, temperature=400.0)
    temperature = drive(gas, np.full(40, 0.002))[:, 2]
    assert (np.diff(temperature) <= 1e-9).all() and temperature[-1] == pytest.approx(293.15, abs=0.01)


def warmed(speed: float, stirring: float) -> float:
    """Return the heat that both chambers, 20 K colder than their walls, take in 2 ms behind a piston of this speed [J]."""
    gas = bench()
    gas.cylinders["wall_heat_transfer"]["conductance"] = CONDUCTANCE
    gas.cylinders["heat_transfer_law"]["stirring"] = stirring
    gas.fill(np.full(1, 0.05), 4e5, 4e5, temperature=273.15)
    drive(gas, np.linspace(0.05, 0.05 + 2.0 * speed * gas.dt, 3))
    return float(gas.integrated[0, state.HEAT])


def test_gas_behind_a_moving_piston_exchanges_more() -> None:
    assert cooled(0.05, 4e5, 0.0, 0.0, 0.4) == pytest.approx(0.6 * CONDUCTANCE, rel=1e-3)
    assert warmed(SPEED, 0.7) == pytest.approx(warmed(SPEED, 0.0), rel=1e-3)
    assert warmed(0.3, 0.7) / warmed(0.3, 0.0) == pytest.approx(0.3 + 0.7 * 3.0**0.8, rel=0.01)
    assert warmed(-0.3, 0.7) == pytest.approx(warmed(0.3, 0.7), rel=0.01)


def test_gas_that_flows_in_stirs_what_is_there() -> None:
    """A locked chamber loses more in the same fill, and as much per second as before when that is over."""

    def lost(stirring: float) -> tuple[float, float]:
        gas = bench(dead=2e-5)
        gas.cylinders["wall_heat_transfer"]["conductance"] = 0.05
        gas.cylinders["heat_transfer_law"]["stirring"] = stirring
        gas.fill(np.full(1, 0.05), 2e5, 2e5)
        at = np.full(1, 0.05)
        flow = []
        for _ in range(5):
            before = gas.integrated[0, state.MASS_1]
            hold(gas, 0.2, gas.dt, 0.05)
            flow.append((gas.integrated[0, state.MASS_1] - before) / gas.dt)
        p, t = gas.pressures(at)[0, 0], gas.temperatures()[0, 0]
        return -float(gas.integrated[0, state.HEAT]), float(np.mean(flow)) * R * t / (p * gas.cylinders["area_1"][0])

    plain, speed = lost(0.0)
    assert 0.1 < speed < FASTEST
    assert lost(0.5)[0] > 1.2 * plain


def test_it_stays_stable_where_a_jet_stirs_a_small_chamber() -> None:
    gas = bench()
    gas.cylinders["wall_heat_transfer"]["conductance"] = 20.0
    gas.cylinders["heat_transfer_law"]["stirring"] = 1.0
    gas.fill(np.full(1, 0.002), 1.5e5, 1.5e5)
    temperature = drive(gas, np.full(40, 0.002), command=1.0)[:, 2]
    assert np.isfinite(temperature).all() and temperature.min() > 280.0 and temperature.max() < 420.0


@pytest.mark.parametrize("number", ["exposure = 1.0", "exponent = 0.5", "stirring = 0.8"])
def test_a_rig_may_say_each_number_of_the_law_alone(tmp_path: Path, number: str) -> None:
    """A fit may end at none of the others, and the improved rig then leaves them out."""
    rig = benches.bench(tmp_path)
    heat = f'[effects.wall_heat_transfer.piston]\nconductance = "1 W/K"\n\n[effects.heat_transfer_law.piston]\n{number}\n'
    law = parse(f"{rig.text}\n{heat}", rig.path).effect("heat_transfer_law", "piston")
    assert law is not None and list(law.parameters) == [number.split()[0]]
