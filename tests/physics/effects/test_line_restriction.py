"""Known limits of line restriction: closed forms and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from physics.air import PA, K
from physics.stepping import hold, tank
from scipy.optimize import brentq

from exo_sim.physics import nozzle, state
from exo_sim.physics.effects import line_restriction
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder


def test_a_hose_of_a_low_ratio_passes_the_ellipse() -> None:
    """ISO 6358 at 0.8 with b = 0.3: sqrt(1 - (0.5/0.7)^2) of choked flow; choked flow is the nozzle's."""
    hose = paper_cylinder(0.032, 0.012, 0.1, 5e-6)["line_restriction"][0].copy()
    hose["ratio"] = 0.3
    choked = nozzle.flow(1e-6, 5e5, 293.0, 1e5, 293.0, K, 287.05)
    assert line_restriction.flow(hose, 1e-6, 5e5, 293.0, 1e5, 293.0, K, 287.05) == pytest.approx(choked, rel=1e-12)
    expected = choked * math.sqrt(1.0 - (0.5 / 0.7) ** 2)
    assert line_restriction.flow(hose, 1e-6, 5e5, 293.0, 4e5, 293.0, K, 287.05) == pytest.approx(expected, rel=1e-12)
    assert line_restriction.flow(hose, 1e-6, 4e5, 293.0, 5e5, 293.0, K, 287.05) == pytest.approx(-expected, rel=1e-12)


def test_hose_lies_between_valve_and_chamber() -> None:
    gas = tank(1.0, 2e-6, dt=1e-3)
    gas.cylinders["line_restriction"]["area"], gas.cylinders["line_restriction"]["volume"] = 2e-6, 1e-5
    gas.fill(np.zeros(1), PA, PA)
    hold(gas, 1.0, 0.3)
    node = (K - 1) * gas.integrated[0, state.HOSE_ENERGY_1] / 1e-5
    assert node == pytest.approx(565220.8, rel=1e-3)  # the chamber behind has risen by 0.1 % meanwhile
    assert gas.books().mass_residual < 1e-10


def test_wide_hose_only_adds_its_volume() -> None:
    gas, paper = tank(5e-5, 1e-6, dt=1e-3), tank(6e-5, 1e-6, dt=1e-3)
    gas.cylinders["line_restriction"]["area"], gas.cylinders["line_restriction"]["volume"] = 1e-3, 1e-5
    for each in (gas, paper):
        each.fill(np.zeros(1), 2e5, 2e5)
        hold(each, 1.0, 0.05)
    assert gas.pressures(np.zeros(1)) == pytest.approx(paper.pressures(np.zeros(1)), rel=1e-4)


def test_the_critical_ratio_of_a_hose_in_the_units_that_the_effect_names() -> None:
    """b = 474 C/D^2 with C = 0.029 D^2/sqrt(L/D^1.25 + 510), all in SI, of hoses of 3 to 8 mm and 0.3 to 2 m."""
    ratios = [474.0 * 0.029 / math.sqrt(length / bore**1.25 + 510.0) for bore in (0.003, 0.008) for length in (0.3, 2.0)]
    (said,) = [one.source for one in line_restriction.EFFECT.parameters if one.name == "ratio"]
    assert f"C in m^3/(s Pa), D in m): {min(ratios):.2f}-{max(ratios):.2f}" in said


def line(volume: float, area: float, hose: float, length: float, longest: float = 2e-5) -> Pneumatics:
    """Return a vessel behind a hose of some length whose valve is shut; volumes in m^3, steps of 0.1 ms."""
    gas = tank(volume, 1e-12, dt=1e-4)
    there = gas.cylinders["line_restriction"]
    there["area"], there["volume"], there["length"] = area, hose, length
    gas.world["longest_step"], gas.world["most_steps"] = longest, 1000.0
    return gas


def test_the_gas_in_a_long_hose_swings_as_a_pipe_does() -> None:
    """A shut pipe of 2 m and 40 cm^3 before a vessel of 60 cm^3, the vessel pushed: tan(w L / a) = -(V_c / V) w L / a, its first root."""
    hose, vessel, length = 4e-5, 6e-5, 2.0
    gas = line(vessel, 1e-3, hose, length)
    gas.fill(np.zeros(1), 4e5, 4e5)
    gas.integrated[0, [state.MASS_1, state.ENERGY_1]] *= 1.002
    traces = []
    for _ in range(2000):
        gas.advance(np.zeros(1), np.zeros(1), np.zeros(1))
        traces.append(float(gas.pressures(np.zeros(1))[0, 0]))
    trace = np.array(traces) - np.mean(traces)
    up = np.flatnonzero((trace[:-1] < 0.0) & (trace[1:] >= 0.0))
    at = up - trace[up] / (trace[up + 1] - trace[up])
    sound = math.sqrt(K * 287.05 * 293.15)
    root = brentq(lambda z: math.sin(z) + vessel / hose * z * math.cos(z), 0.5 * math.pi, math.pi)
    found = 2.0 * math.pi * 1e4 / float(np.mean(np.diff(at)))
    assert found == pytest.approx(root * sound / length, rel=0.1)  # two lumps of a continuous line
    early, late = (float(np.ptp(part)) for part in (trace[:300], trace[-300:]))
    assert late < 0.9 * early  # the wall takes it


def test_what_passes_a_long_hose_steadily_is_what_a_short_one_passes() -> None:
    """The flow settles where the throttle takes all of the drop; a slow one where the wall does (Hagen and Poiseuille)."""
    for p_up, ratio in ((6e5, 0.0), (6e5, 0.3), (1.5e5, 0.0)):
        hose = line(1.0, 4e-6, 3e-5, 2.0).cylinders["line_restriction"][0].copy()
        hose["ratio"] = ratio
        steady = line_restriction.flow(hose, 4e-6, p_up, 293.0, 1e5, 293.0, K, 287.05)
        whole = line_restriction.resistance(hose, 4e-6, p_up, 293.0, 1e5, 293.0, K, 287.05)
        middle = 0.5 * (p_up + 1e5)
        for ends in ((p_up, middle), (middle, 1e5)):
            grows = line_restriction.acceleration(hose, whole, steady, ends[0], 293.0, ends[1], 293.0, 287.05)
            assert abs(grows) < 1e-9 * 1.5e-5 * (p_up - 1e5)
    radius = math.sqrt(1.5e-5 / math.pi)
    density = 1.001e5 / (287.05 * 293.0)
    volume_flow = math.pi * radius**4 * 1.0 / (8.0 * 1.8e-5 * 1.0)  # of 1 Pa over the metre that a half is long
    slow = line_restriction.acceleration(hose, 0.0, density * volume_flow, 1.001e5 + 0.5, 293.0, 1.001e5 - 0.5, 293.0, 287.05)
    assert abs(slow) < 1e-9 * 1.5e-5


def test_a_long_hose_keeps_gas_and_energy_and_leads_to_the_same_rest() -> None:
    gas = line(6e-5, 4e-6, 4e-5, 2.0)
    gas.cylinders["valve_area"] = 4e-6
    gas.fill(np.zeros(1), 2e5, 2e5)
    for _ in range(3000):
        gas.advance(np.zeros(1), np.zeros(1), np.ones(1))
    books = gas.books()
    assert books.mass_residual < 1e-10 and books.energy_residual < 1e-10
    assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(float(gas.world["supply_pressure"][0]), rel=1e-3)
    assert abs(gas.integrated[0, state.HOSE_FLOW_1]) < 5e-5


@pytest.mark.parametrize("length", [0.0, 2.0])
def test_a_shut_hose_takes_the_temperature_of_its_wall(length: float) -> None:
    """Warm gas in hose and vessel, the vessel's wall adiabatic: their heat leaves by the hose's wall, C dT/dt = -G (T - T0).

    A conductance so small that the gas is everywhere as warm: m c_v = 4e5 Pa of 1e-4 m^3 over (k - 1) T.
    """
    vessel, hose, conductance, seconds = 1e-6, 9.9e-5, 0.05, 3.0
    gas = line(vessel, 1e-3, hose, length)
    gas.cylinders["line_restriction"]["conductance"] = conductance
    room = float(gas.world["ambient"][0])
    gas.fill(np.zeros(1), 4e5, 4e5, temperature=1.1 * room)
    gas.dt = 1e-3
    for _ in range(int(seconds / gas.dt)):
        gas.advance(np.zeros(1), np.zeros(1), np.zeros(1))
    capacity = 4e5 * (vessel + hose) / ((K - 1.0) * 1.1 * room)
    left = 0.1 * math.exp(-seconds * conductance / capacity)
    assert left < 0.09
    assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(4e5 * (1.0 + left) / 1.1, rel=2e-3)
    assert gas.books().energy_residual < 1e-9


def test_a_wall_that_takes_all_heat_makes_the_hose_a_larger_volume() -> None:
    """Of a small fast change an isothermal volume V holds as much gas as an adiabatic one of k V."""
    rises = []
    for conductance, hose in ((80.0, 1e-5), (0.0, K * 1e-5)):
        gas = line(1e-6, 1e-3, hose, 0.0)
        gas.cylinders["line_restriction"]["conductance"] = conductance
        gas.cylinders["valve_area"] = 1e-7
        gas.fill(np.zeros(1), 4e5, 4e5)
        for _ in range(100):
            gas.advance(np.zeros(1), np.zeros(1), np.ones(1))
        rises.append(float(gas.pressures(np.zeros(1))[0, 0]) - 4e5)
    assert rises[0] > 1e3
    assert rises[0] == pytest.approx(rises[1], rel=0.05)


def test_the_length_of_a_step_makes_little_difference_in_a_long_hose() -> None:
    ends = []
    for longest in (1e-3, 2e-5):
        gas = line(6e-5, 4e-6, 4e-5, 2.0, longest)
        gas.cylinders["valve_area"] = 3e-6
        gas.dt = 1e-3
        gas.fill(np.zeros(1), 3e5, 3e5)
        trace = []
        for i in range(500):
            gas.advance(np.zeros(1), np.zeros(1), np.array([1.0 if (i // 60) % 2 else -1.0]))
            trace.append(float(gas.pressures(np.zeros(1))[0, 0]))
        ends.append(np.array(trace))
    assert float(np.sqrt(np.mean((ends[0] - ends[1]) ** 2))) < 0.004 * float(np.ptp(ends[1]))
