"""The whole plant against golden trajectories, other integrators and its own books."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from physics.stepping import drive, free, hold, tank
from scipy.integrate import solve_ivp

from exo_sim.physics import plant, state
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world

PA = 101325.0


def golden_double(dt: float) -> Pneumatics:
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.2, 2e-6), dt=dt)
    gas.fill(np.array([0.1]), 3e5, 3e5)
    return gas


@pytest.mark.parametrize(
    ("t", "x", "v", "p_1", "t_1", "p_2", "t_2"),
    [
        (0.02, 0.100585706, 0.076012538, 393625.0101, 314.4276794, 257901.1381, 280.7550740),
        (0.05, 0.106659294, 0.355211479, 492363.1454, 327.9448063, 221492.8365, 268.8089570),
        (0.10, 0.139623232, 0.953209008, 487139.5514, 317.7288516, 248755.1729, 277.8736008),
    ],
)
def test_golden_double_acting(t: float, x: float, v: float, p_1: float, t_1: float, p_2: float, t_2: float) -> None:
    gas = golden_double(2e-5)
    found = free(gas, 20.0, 0.1, 0.0, round(t / 2e-5), 1.0)[-1]
    assert found[:2] == pytest.approx([x, v], abs=1e-8)
    assert found[2:] == pytest.approx([p_1, p_2], rel=1e-8)
    assert gas.temperatures()[0] == pytest.approx([t_1, t_2], rel=1e-8)
    if t == 0.10:
        assert gas.integrated[0, [state.MASS_1, state.MASS_2]] == pytest.approx([5.9977272705e-4, 1.3013966754e-4], rel=1e-8)


@pytest.mark.parametrize(
    ("t", "x", "v", "p", "temperature"),
    [
        (0.01, 0.020161644, 0.048345926, 339706.7612, 366.1086276),
        (0.03, 0.024057322, 0.376502229, 599465.0758, 367.5870772),
        (0.06, 0.043983820, 0.928942999, 495766.6435, 320.9898724),
    ],
)
def test_golden_single_acting(t: float, x: float, v: float, p: float, temperature: float) -> None:
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.2, 2e-6, single_acting=True), dt=1e-5)
    gas.fill(np.array([0.02]), PA, PA)
    found = free(gas, 20.0, 0.02, 0.0, round(t / 1e-5), 1.0)[-1]
    assert found[:2] == pytest.approx([x, v], abs=1e-8)
    assert found[2] == pytest.approx(p, rel=3e-8)
    assert found[3] == PA
    assert gas.temperatures()[0, 0] == pytest.approx(temperature, rel=3e-8)


def continuous(gas: Pneumatics, mass: float, x: float, seconds: float, method: str) -> NDArray[np.float64]:
    """Return (x, v, p_1, p_2) after the same motion by an integrator of scipy's."""
    size = state.integrated_size(1)
    world, cylinders = gas.world[0], gas.cylinders

    def rates(_: float, z: NDArray[np.float64]) -> NDArray[np.float64]:
        y, dy = np.ascontiguousarray(z[:size]), np.zeros(size)
        plant.rates(world, cylinders, y, dy, 0.0, z[size : size + 1], z[size + 1 :], np.array([1.0, -1.0]))
        p_1, p_2 = plant.pressures(world, cylinders[0], y, 0, z[size])
        c = cylinders[0]
        push = p_1 * c["area_1"] - p_2 * c["area_2"] - world["atmosphere"] * (c["area_1"] - c["area_2"])
        return np.concatenate([dy, [z[size + 1], push / mass]])

    start = np.concatenate([gas.vector[:size], [x, 0.0]])
    scale = np.maximum(np.abs(start), 1e-6)
    end = solve_ivp(rates, (0.0, seconds), start, method, rtol=1e-10, atol=1e-10 * scale, max_step=2e-3).y[:, -1]
    return np.array([end[size], end[size + 1], *plant.pressures(world, cylinders[0], end[:size], 0, end[size])])


@pytest.mark.parametrize("method", ["Radau", "DOP853"])
def test_other_integrators_agree_to_second_order(method: str) -> None:
    reference = continuous(golden_double(1e-3), 20.0, 0.1, 0.08, method)
    errors = []
    for dt in (2e-3, 1e-3, 5e-4):
        found = free(golden_double(dt), 20.0, 0.1, 0.0, round(0.08 / dt), 1.0)[-1]
        errors.append(np.abs(found / reference - 1.0).max())
    assert errors[1] < 5e-5
    assert 3.0 < errors[1] / errors[2] < 5.5


def test_order_of_convergence_is_two() -> None:
    ends = [free(golden_double(dt), 20.0, 0.1, 0.0, round(0.08 / dt), 1.0)[-1] for dt in (4e-4, 2e-4, 1e-4)]
    order = np.log2(np.abs(ends[0] - ends[1]) / np.abs(ends[1] - ends[2]))
    assert order == pytest.approx(np.full(4, 2.0), abs=0.15)


@settings(max_examples=20)
@given(st.integers(0, 2**31), st.floats(0.2e-6, 12e-6), st.floats(0.1, 5.0))
def test_books_close_whatever_the_valve_does(seed: int, area: float, mass: float) -> None:
    rng = np.random.default_rng(seed)
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.2, area, 2e-6, 2e-6), dt=1e-3)
    gas.fill(np.array([0.1]), 3e5, 3e5)
    found = free(gas, 10 * mass, 0.1, 0.0, 50, np.repeat(rng.uniform(-1, 1, 10), 5))
    books = gas.books()
    assert np.isfinite(found).all()
    assert books.mass_residual < 1e-11 and books.energy_residual < 1e-11


def test_conserved_to_the_last_digits_over_a_long_run() -> None:
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.2, 5e-6, 3e-6, 3e-6), dt=1e-3)
    gas.fill(np.array([0.1]), 3e5, 3e5)
    t = np.arange(10000) * 1e-3
    at = 0.1 + 0.05 * np.sin(2 * np.pi * t)
    for i in range(len(t) - 1):
        gas.advance(at[i : i + 1], at[i + 1 : i + 2], np.sin([7 * t[i]]))
    books = gas.books()
    assert books.mass_residual < 1e-9 and books.energy_residual < 1e-9
    assert books.drawn[0] > 5e-3  # enough passed through for that to mean something


@pytest.mark.parametrize("dead_volume", [1e-7, 1e-8, 1e-9])
def test_tiny_volumes_behind_a_wide_open_valve_stay_stable(dead_volume: float) -> None:
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.2, 12e-6, dead_volume, dead_volume), dt=1e-3)
    gas.fill(np.array([0.0]), 3e5, 3e5)
    hold(gas, 1.0, 0.02)
    p_1, p_2 = gas.pressures(np.zeros(1))[0]
    assert p_1 == pytest.approx(7e5, rel=1e-6)
    assert PA < p_2 < 3e5
    hold(gas, -1.0, 0.02)
    assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(PA, rel=1e-6)
    assert gas.temperatures()[0].min() > 150.0 and gas.temperatures()[0].max() < 700.0


def test_a_vented_cylinder_goes_to_the_atmosphere_whatever_is_commanded() -> None:
    gas = tank(5e-5, 5e-6, dt=1e-3)
    gas.cylinders["vented"] = 1.0
    gas.fill(np.zeros(1), 5e5, 3e5)
    hold(gas, 1.0, 1.0)
    assert gas.pressures(np.zeros(1))[0] == pytest.approx([PA, PA], rel=1e-9)
    assert gas.books().drawn[0] == 0.0


def test_a_free_piston_between_open_chambers_stays_where_it_is() -> None:
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.2, 5e-6), dt=1e-3)
    gas.cylinders["vented"] = 1.0
    gas.fill(np.array([0.1]), PA, PA)
    assert free(gas, 1.0, 0.1, 0.0, 1000)[-1, :2] == pytest.approx([0.1, 0.0], abs=1e-12)


def test_gas_work_is_force_times_displacement() -> None:
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.2, 2e-6), dt=1e-4)
    gas.fill(np.array([0.05]), 4e5, 2e5)
    path = np.linspace(0.05, 0.15, 2001)
    force = drive(gas, path, 1.0)[:, 4]
    c = gas.cylinders[0]
    rod = PA * (c["area_1"] - c["area_2"]) * 0.1
    assert np.trapezoid(force, path) + rod == pytest.approx(gas.books().work[0], rel=2e-7)


def test_stiffness_of_two_closed_chambers() -> None:
    for dead, expected in ((0.0, 22198.067690), (4e-6, 20044.614249)):
        gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.1, 5e-6, dead, dead), dt=1e-3)
        gas.fill(np.array([0.05]), 5e5, 565237.727273)
        assert gas.forces(np.array([0.05]), np.zeros(1))[0] == pytest.approx(0.0, abs=1e-6)
        ends = []
        for step in (-1e-5, 1e-5):
            gas.fill(np.array([0.05]), 5e5, 565237.727273)
            ends.append(drive(gas, np.linspace(0.05, 0.05 + step, 11))[-1, 4])
        assert (ends[0] - ends[1]) / 2e-5 == pytest.approx(expected, rel=1e-6)


def test_a_cylinder_without_effects_takes_a_short_way_to_the_same_bits() -> None:
    """An end cushion of no length acts on nothing, but sends the cylinder the long way."""
    ends = []
    for length in (0.0, 1e-300):
        gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.2, 2e-6, 1e-5, 1e-5), dt=1e-3)
        gas.cylinders["end_cushioning"]["length"] = length
        gas.cylinders["end_cushioning"]["area"] = 1e-6
        gas.fill(np.array([0.1]), 3e5, 4e5)
        time = np.arange(600) * 1e-3
        path = 0.1 + 0.08 * np.sin(20 * time)
        for i in range(1, len(path)):
            gas.advance(path[i - 1 : i], path[i : i + 1], np.array([np.sin(9 * time[i])]))
        ends.append(gas.vector.copy())
    assert np.array_equal(ends[0], ends[1])
    assert ends[0][state.DRAWN] > 0.0
    assert ends[0][state.EXHAUSTED] > 0.0


@pytest.mark.parametrize("hose", [0.0, 4e-6])
def test_without_books_the_gas_does_the_same(hose: float) -> None:
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.1, 5e-6, 3e-6, 3e-6), dt=1e-3)
    gas.cylinders["line_restriction"]["area"], gas.cylinders["line_restriction"]["volume"] = hose, 5e-6
    gas.cylinders["wall_heat_transfer"]["conductance"], gas.cylinders["coulomb_friction"]["force"] = 0.3, 20.0
    gas.fill(np.array([0.03]), 3e5, 4e5)
    full, bare = gas.vector.copy(), gas.vector.copy()
    work, scratch = np.zeros((2, 5, state.integrated_size(1))), np.zeros((5, 2))
    for i in range(200):
        x0, x1, command = np.array([0.03 + 1e-4 * i]), np.array([0.03 + 1e-4 * (i + 1)]), np.array([np.sin(0.2 * i)])
        for books, vector in ((True, full), (False, bare)):
            plant.advance(gas.world[0], gas.cylinders, vector, x0, x1, command, 1e-3, work[int(books)], scratch, books)
    np.testing.assert_array_equal(full[: state.DRAWN], bare[: state.DRAWN])
    assert full[state.DRAWN] > 0.0 and bare[state.DRAWN] == 0.0
    assert full[state.integrated_size(1) + state.BRISTLE] != 0.0
