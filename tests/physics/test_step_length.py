"""How many stages a step takes: never fewer than the fastest mode of the rates needs, and no step's error hangs on their number."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from exo_sim.physics import plant, state
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world
from exo_sim.physics.runge_kutta_chebyshev import REACH
from exo_sim.physics.step_length import step_length

MM2, CM3 = 1e-6, 1e-6


def machine(hose: float, volume: float, valve: float = 2.0, dead: float = 5.0, tank: float = 0.0, silencer: float = 0.0) -> Pneumatics:
    """Return a cylinder behind hoses, areas in mm^2 and volumes in cm^3; zero leaves tank or silencer out."""
    world, cylinder = paper_world(), paper_cylinder(0.025, 0.01, 0.16, valve * MM2, dead * CM3, dead * CM3)
    cylinder["line_restriction"]["area"], cylinder["line_restriction"]["volume"] = hose * MM2, volume * CM3
    if tank:
        world["supply_droop"]["volume"], world["supply_droop"]["conductance"] = tank * CM3, 1e-8
    if silencer:
        world["exhaust_back_pressure"]["area"], world["exhaust_back_pressure"]["volume"] = silencer * MM2, 5.0 * CM3
    return Pneumatics(world, cylinder, dt=1e-3)


def fastest_mode(gas: Pneumatics, x: float, opening: float) -> float:
    """Return the largest rate at which the gas settles [1/s]: an eigenvalue of the rates' Jacobian, by differences."""
    size = state.integrated_size(1)
    y, at, still, spool = gas.vector[:size].copy(), np.array([x]), np.zeros(1), np.array([opening, -opening])

    def rates(z: NDArray[np.float64]) -> NDArray[np.float64]:
        dy = np.zeros(size)
        plant.rates(gas.world[0], gas.cylinders, z, dy, 0.0, at, still, spool)
        return dy

    columns = []
    for j in range(size):
        step = np.zeros(size)
        step[j] = 1e-7 * max(abs(y[j]), 1e-9)
        columns.append((rates(y + step) - rates(y - step)) / (2.0 * step[j]))
    return float(np.abs(np.linalg.eigvals(np.array(columns).T).real).max())


@settings(max_examples=200, deadline=None)
@given(
    hose=st.floats(0.5, 30.0), volume=st.floats(0.5, 30.0), valve=st.floats(0.5, 12.0), x=st.floats(0.0, 0.16),
    tank=st.sampled_from([0.0, 20.0, 500.0]), silencer=st.sampled_from([0.0, 2.0, 10.0]), opening=st.floats(-1.0, 1.0),
    apart=st.floats(-0.02, 0.02), warm=st.floats(0.6, 1.7), span=st.sampled_from([1e-4, 2.5e-4, 1e-3]),
)  # fmt: skip
def test_the_stages_of_a_step_reach_the_fastest_mode(
    hose: float, volume: float, valve: float, x: float, tank: float, silencer: float, opening: float, apart: float,
    warm: float, span: float,
) -> None:
    gas = machine(hose, volume, valve, tank=tank, silencer=silencer)
    gas.fill(np.array([x]), 4e5, 4e5)
    gas.vector[state.HOSE_ENERGY_1] *= 1.0 + apart
    gas.vector[state.HOSE_MASS_1] /= warm
    gas.world["longest_step"] = span
    size, at = state.integrated_size(1), np.array([x])
    h, stages = step_length(gas.world[0], gas.cylinders, gas.vector[:size], 0.0, at, at, np.array([opening, -opening]), 1e-3, 1e-7, 0.0)
    assert h * fastest_mode(gas, x, opening) <= 1.02 * REACH[stages]


@pytest.mark.parametrize(("hose", "volume", "valve"), [(4.6, 5.4, 1.05), (5.3, 5.4, 1.05), (15.0, 1.0, 4.0), (30.0, 3.0, 4.0)])
def test_the_length_of_a_step_makes_no_difference_behind_a_hose(hose: float, volume: float, valve: float) -> None:
    """A chamber behind its hose settles faster than either alone: with too few stages, or with fast modes that hardly fade, a step
    rings, and the pressure is hundreds of pascals off."""
    t = np.arange(1000) * 2e-3
    at = 0.08 + 0.05 * np.sin(2 * np.pi * 0.7 * t)
    command = np.sin(2 * np.pi * 1.3 * t) * (np.sin(2 * np.pi * 0.4 * t) > 0.0)
    traces = []
    for longest in (1e-3, 5e-4, 2.5e-4, 2e-5):
        gas = machine(hose, volume, valve, dead=12.0)
        gas.dt = 2e-3
        gas.world["longest_step"], gas.world["most_steps"] = longest, 1000.0
        gas.fill(at[:1], 4e5, 3.5e5)
        trace = []
        for i in range(len(t) - 1):
            gas.advance(at[i : i + 1], at[i + 1 : i + 2], command[i : i + 1])
            trace.append(gas.pressures(at[i + 1 : i + 2])[0].copy())
        traces.append(np.array(trace))
    errors = [float(np.sqrt(np.mean((coarse - traces[-1]) ** 2))) for coarse in traces[:-1]]
    assert errors[0] < 15.0 and errors[1] < 5.0 and errors[2] < 1.5
