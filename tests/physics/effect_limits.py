"""The known limits of every effect: closed forms and published numbers. `test_effects.py` visits them."""

from __future__ import annotations

import math
from collections import namedtuple
from collections.abc import Callable, Mapping

import numpy as np
import pytest
from numpy.typing import NDArray
from physics.stepping import drive, hold, tank
from scipy.optimize import brentq

from exo_sim.physics import gas as nozzle
from exo_sim.physics import plant, state
from exo_sim.physics.conditions import Chamber, Motion
from exo_sim.physics.effects import end_cushioning, external_leakage, line_restriction, sensor_bias, sensor_delay, sensor_scale, unknown
from exo_sim.physics.forces import joint_forces
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world
from exo_sim.physics.records import JOINT
from exo_sim.physics.resistance import dry_force, dry_level, joint_dry_level, joint_resistance, move_bristle

K, R, PA = 1.4, 287.05, 101325.0
CV, CP = R / (K - 1), K * R / (K - 1)

_Cushion = namedtuple("_Cushion", "length area")

LIMITS: dict[str, list[Callable[[], None]]] = {}


def limit_of(name: str) -> Callable[[Callable[[], None]], Callable[[], None]]:
    """Enter a function as a known limit of an effect."""

    def enter(function: Callable[[], None]) -> Callable[[], None]:
        LIMITS.setdefault(name, []).append(function)
        return function

    return enter


def bench(dt: float = 1e-3, p_1: float = 5e5, p_2: float = 565237.727273, x: float = 0.05, dead: float = 0.0) -> Pneumatics:
    """Return a 32/12 x 100 mm cylinder, not yet filled unless pressures balance at mid-stroke (A.4.10)."""
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.1, 5e-6, dead, dead), dt=dt)
    gas.fill(np.array([x]), p_1, p_2)
    return gas


def slide(
    joint: NDArray[np.void], mass: float, v: float, load: Callable[[float, float], float], seconds: float, dt: float, q: float = 0.0
) -> NDArray[np.float64]:
    """Move a mass on a joint with friction of its own under load(t, q) [N]; return (q, v) after every step, shape (n + 1, 2)."""
    joint["effective_mass"], joint["step"] = mass, dt
    bristle, force = np.zeros(1), np.zeros(1)
    out = [(q, v)]
    for i in range(round(seconds / dt)):
        joint_forces(joint, bristle, np.array([q]), np.array([v]), force)
        v += dt * (force[0] + load(i * dt, q)) / mass
        level = joint_dry_level(joint[0], Motion(q, v, bristle[0], 0.0, 0.0))
        bristle[0] = move_bristle(joint[0], bristle[0], v, level, dt)
        q += dt * v
        out.append((q, v))
    return np.array(out)


def contact(**effects: Mapping[str, float]) -> NDArray[np.void]:
    """Return one joint with these effects on."""
    joint = np.zeros(1, JOINT)
    for name, numbers in effects.items():
        for key, value in numbers.items():
            joint[name][key] = value
    return joint


def constant(force: float) -> Callable[[float, float], float]:
    return lambda t, q: force


def nothing(t: float, q: float) -> float:
    """No load."""
    return 0.0


@limit_of("wall_heat_transfer")
def relaxes_to_the_plateau_after_an_adiabatic_fill() -> None:
    gas = tank(1e-3, 5e-6, dt=1e-3)
    gas.fill(np.zeros(1), PA, PA)
    hold(gas, 1.0, 1.2)
    assert gas.temperatures()[0, 0] == pytest.approx(387.947821155, rel=1e-8)
    gas.cylinders["wall_heat_transfer"]["conductance_1"] = 10.0
    hold(gas, 0.0, 15.0)
    assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(7e5 * 293.15 / 387.947821155, rel=1e-7)
    assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(5.2895e5, abs=6.0)


@limit_of("wall_heat_transfer")
def cools_exponentially_at_constant_volume() -> None:
    gas = tank(1e-4, 5e-6, dt=1e-3)
    gas.cylinders["wall_heat_transfer"]["conductance"] = 0.8
    gas.fill(np.zeros(1), 6e5, 6e5, temperature=353.15)
    tau = 6e5 * 1e-4 / (R * 353.15) * CV / 0.8
    hold(gas, 0.0, 0.5)
    assert gas.temperatures()[0] - 293.15 == pytest.approx(60.0 * math.exp(-0.5 / tau), rel=1e-6)


@limit_of("wall_heat_transfer")
def sealed_piston_shows_the_complex_polytropic_exponent() -> None:
    for scaled, size, degrees in ((0.1, 1.004741, 2.259), (1 / math.sqrt(K), 1.183216, 9.594068), (10.0, 1.396601, 1.625)):
        gas = bench(p_1=6e5, p_2=6e5)
        mass = gas.integrated[0, state.MASS_1]
        tau = 0.5
        gas.cylinders["wall_heat_transfer"]["conductance_1"] = mass * CV / tau
        period = 2 * math.pi * tau / scaled
        gas.dt = period / 2000
        phase = np.arange(2000 * (4 if scaled < 5 else 12)) * 2 * math.pi / 2000
        found = drive(gas, 0.05 * (1.0 + 1e-4 * np.sin(phase)))[:, 0] / 6e5
        last = slice(-2000, None)
        n = 2.0 * np.mean(found[last] * np.exp(-1j * phase[last])) / (1j * 1e-4)
        assert abs(n) == pytest.approx(size, rel=2e-4)
        assert math.degrees(np.angle(n)) == pytest.approx(degrees, abs=0.02)


@limit_of("moving_wall_temperature")
def gas_and_wall_meet_in_the_middle() -> None:
    gas = tank(1e-4, 5e-6, dt=1e-3)
    gas.cylinders["wall_heat_transfer"]["conductance"] = 2.0
    gas.cylinders["moving_wall_temperature"]["heat_capacity"] = 1.5
    gas.fill(np.zeros(1), 6e5, 6e5, temperature=393.15)
    own = 6e5 * 1e-4 / (R * 393.15) * CV
    hold(gas, 0.0, 3.0)
    met = (own * 393.15 + 1.5 * 293.15) / (own + 1.5)
    assert gas.temperatures()[0] == pytest.approx(met, rel=1e-7)
    assert gas.integrated[0, state.WALL_1] == pytest.approx(met, rel=1e-7)


@limit_of("moving_wall_temperature")
def warm_wall_cools_outwards() -> None:
    gas = tank(1e-4, 5e-6, dt=1e-3)
    gas.cylinders["moving_wall_temperature"]["heat_capacity"] = 1.5
    gas.cylinders["moving_wall_temperature"]["outside_conductance"] = 3.0
    gas.fill(np.zeros(1), 6e5, 6e5)
    gas.integrated[0, state.WALL_1] = 313.15
    hold(gas, 0.0, 0.5)
    assert gas.integrated[0, state.WALL_1] - 293.15 == pytest.approx(20.0 * math.exp(-1.0), rel=1e-6)


@limit_of("piston_leakage")
def chambers_meet_at_the_mean_weighted_by_volume() -> None:
    for key, value in (("area", 1e-7), ("laminar", 1e-14)):
        gas = tank(5e-5, 5e-6, dt=1e-3)
        gas.cylinders["dead_volume_2"] = 2e-5
        gas.cylinders["piston_leakage"][key] = value
        gas.fill(np.zeros(1), 6e5, 2e5)
        energy = gas.integrated[0, [state.ENERGY_1, state.ENERGY_2]].sum()
        hold(gas, 0.0, 0.05)
        between = gas.pressures(np.zeros(1))[0]
        assert 6e5 > between[0] > between[1] > 2e5
        hold(gas, 0.0, 8.0)
        v = np.array(plant.volumes(gas.cylinders[0], 0.0))
        assert gas.pressures(np.zeros(1))[0] == pytest.approx((6e5 * v[0] + 2e5 * v[1]) / v.sum(), rel=1e-6)
        assert gas.integrated[0, [state.ENERGY_1, state.ENERGY_2]].sum() == pytest.approx(energy, rel=1e-12)


@limit_of("piston_leakage")
def leaks_to_the_air_where_chamber_2_is_the_air() -> None:
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.1, 5e-6, 5e-5, 0.0, single_acting=True), dt=1e-3)
    gas.cylinders["piston_leakage"]["area"] = 1e-7
    gas.fill(np.zeros(1), 6e5, PA)
    hold(gas, 0.0, 5.0)
    assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(PA, rel=1e-4)
    assert gas.books().mass_residual < 1e-12


@limit_of("external_leakage")
def empties_exponentially_in_501_seconds() -> None:
    """C = 1e-12 m^3/(s Pa) on 50 cm^3 at 6 bar (B3): 501 s, 1197 Pa/s, 2.16 dm^3/h of free air."""
    area = 1e-12 * 5.020208972e-6 / 1e-8
    gas = tank(5e-5, 5e-6, dt=5e-3)
    gas.cylinders["external_leakage"]["area_1"] = area
    gas.cylinders["wall_heat_transfer"]["conductance"] = 100.0
    gas.fill(np.zeros(1), 6e5, 6e5)
    flow = nozzle.mass_flow(area, 6e5, 293.15, PA, K, R)
    tau = gas.integrated[0, state.MASS_1] / flow
    assert tau == pytest.approx(501.4, abs=0.1)
    assert 6e5 / tau == pytest.approx(1197.0, abs=0.5)
    assert flow / 1.185 * 3.6e6 == pytest.approx(2.160, abs=2e-3)
    hold(gas, 0.0, 10.0)
    assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(6e5 * math.exp(-10.0 / tau), rel=5e-6)
    assert gas.pressures(np.zeros(1))[0, 1] == 6e5


@limit_of("external_leakage")
def porous_path_obeys_its_law_in_both_directions() -> None:
    p, world = paper_cylinder(0.032, 0.012, 0.1, 5e-6)["external_leakage"][0], paper_world()[0]
    p["laminar_1"], p["inertial"] = 2.3e-17, 4e18
    for pressure in (8.6e5, 3e5, 1.02e5, 5e4):
        here = Chamber(1, pressure, 293.15, 1e-4, 293.15, 8e-4, 0.05, 0.0, 0.05, 0.0)
        w = external_leakage.outward(p, here, here, world)
        assert w / 2.3e-17 + 4e18 * w * abs(w) == pytest.approx(pressure**2 - PA**2, rel=1e-12)
        assert external_leakage.outward(p, here._replace(side=2), here, world) == 0.0


@limit_of("valve_null_leakage")
def closed_valve_is_two_orifices_in_series() -> None:
    """A.4.6: area in over area out 1 gives 565220.830689 Pa between 7 bar and the atmosphere."""
    gas = tank(2e-5, 5e-6, dt=1e-3)
    gas.cylinders["valve_null_leakage"]["area"] = 3e-7
    gas.fill(np.zeros(1), 3e5, 2e5)
    hold(gas, 0.0, 8.0)
    assert gas.pressures(np.zeros(1))[0] == pytest.approx(565220.830689, rel=1e-9)
    assert gas.temperatures()[0] == pytest.approx(293.15, rel=1e-6)


@limit_of("valve_null_leakage")
def series_orifices_of_other_sizes() -> None:
    for ratio, pressure in ((0.5, 350000.0), (2.0, 661091.836534)):
        gas = tank(2e-5, 1e-6 * ratio, dt=1e-3)
        gas.cylinders["external_leakage"]["area_1"] = 1e-6
        gas.fill(np.zeros(1), 3e5, 2e5)
        hold(gas, 1.0, 3.0)
        assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(pressure, rel=1e-9)


@limit_of("valve_deadband")
def opening_starts_at_the_width_and_ends_at_one() -> None:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6)[0]
    c["valve_deadband"]["width"] = 0.1
    for u, opening in ((0.1, 0.0), (-0.1, 0.0), (0.55, 0.5), (-0.55, -0.5), (1.0, 1.0)):
        assert plant.opening(c, u) == pytest.approx(opening, abs=1e-15)
    gas = tank(5e-5, 5e-6, dt=1e-3)
    gas.cylinders["valve_deadband"]["width"] = 0.1
    gas.fill(np.zeros(1), 3e5, 3e5)
    hold(gas, 0.0999, 1.0)
    assert gas.pressures(np.zeros(1))[0] == pytest.approx([3e5, 3e5], rel=1e-12)
    hold(gas, 0.11, 0.02)
    assert gas.pressures(np.zeros(1))[0, 0] > 3.01e5


@limit_of("valve_offset")
def zero_command_is_the_papers_valve_at_the_shift() -> None:
    gas, paper = tank(5e-5, 5e-6, dt=1e-3), tank(5e-5, 5e-6, dt=1e-3)
    gas.cylinders["valve_offset"]["shift"] = 0.25
    for each, command in ((gas, 0.0), (paper, 0.25)):
        each.fill(np.zeros(1), 3e5, 3e5)
        each.memory[0, state.SPOOL] = command
        hold(each, command, 0.05)
    assert (gas.pressures(np.zeros(1)) == paper.pressures(np.zeros(1))).all()
    assert gas.pressures(np.zeros(1))[0, 0] > 3e5 > gas.pressures(np.zeros(1))[0, 1]


@limit_of("valve_lag")
def delay_is_the_same_fill_later() -> None:
    late, paper = tank(5e-5, 5e-6, dt=1e-3), tank(5e-5, 5e-6, dt=1e-3)
    late.cylinders["valve_lag"]["delay"] = 7e-3
    late = Pneumatics(late.world, late.cylinders, dt=1e-3)
    for each, seconds in ((late, 0.037), (paper, 0.030)):
        each.fill(np.zeros(1), 2e5, 2e5)
        hold(each, 0.5, seconds)
    assert late.pressures(np.zeros(1)) == pytest.approx(paper.pressures(np.zeros(1)), rel=1e-9)


@limit_of("valve_lag")
def spool_follows_in_first_order_whatever_the_step() -> None:
    for dt in (1e-3, 2.5e-4):
        gas = tank(5e-5, 5e-6, dt=dt)
        gas.cylinders["valve_lag"]["time_constant"] = 5e-3
        gas.fill(np.zeros(1), 2e5, 2e5)
        hold(gas, 0.8, 0.012)
        assert gas.memory[0, state.SPOOL] == pytest.approx(0.8 * (1 - math.exp(-12 / 5)), rel=1e-9)


@limit_of("valve_hysteresis")
def loop_is_as_wide_as_its_width() -> None:
    gas = tank(5e-5, 5e-6, dt=1e-3)
    gas.cylinders["valve_hysteresis"]["width"] = 0.06
    gas.fill(np.zeros(1), 2e5, 2e5)
    spools = []
    for command in (0.5, 0.3, -0.5, 0.3):
        hold(gas, command, 0.002)
        spools.append(gas.memory[0, state.SPOOL])
    assert spools == pytest.approx([0.47, 0.33, -0.47, 0.27], abs=1e-15)
    assert spools[1] - spools[3] == pytest.approx(0.06)


@limit_of("spool_rate_limit")
def spool_moves_at_its_rate_and_no_faster() -> None:
    gas = tank(5e-5, 5e-6, dt=1e-3)
    gas.cylinders["spool_rate_limit"]["rate"] = 40.0
    gas.fill(np.zeros(1), 2e5, 2e5)
    hold(gas, 1.0, 0.01)
    assert gas.memory[0, state.SPOOL] == pytest.approx(0.4, rel=1e-12)
    hold(gas, 1.0, 0.03)
    assert gas.memory[0, state.SPOOL] == 1.0


@limit_of("line_restriction")
def a_hose_of_a_low_ratio_passes_the_ellipse() -> None:
    """ISO 6358 at 0.8 with b = 0.3: sqrt(1 - (0.5/0.7)^2) of choked flow; choked flow is the nozzle's."""
    hose = paper_cylinder(0.032, 0.012, 0.1, 5e-6)["line_restriction"][0].copy()
    hose["ratio"] = 0.3
    choked = nozzle.flow(1e-6, 5e5, 293.0, 1e5, 293.0, K, 287.05)
    assert line_restriction.flow(hose, 1e-6, 5e5, 293.0, 1e5, 293.0, K, 287.05) == pytest.approx(choked, rel=1e-12)
    expected = choked * math.sqrt(1.0 - (0.5 / 0.7) ** 2)
    assert line_restriction.flow(hose, 1e-6, 5e5, 293.0, 4e5, 293.0, K, 287.05) == pytest.approx(expected, rel=1e-12)
    assert line_restriction.flow(hose, 1e-6, 4e5, 293.0, 5e5, 293.0, K, 287.05) == pytest.approx(-expected, rel=1e-12)


@limit_of("line_restriction")
def hose_lies_between_valve_and_chamber() -> None:
    gas = tank(1.0, 2e-6, dt=1e-3)
    gas.cylinders["line_restriction"]["area"], gas.cylinders["line_restriction"]["volume"] = 2e-6, 1e-5
    gas.fill(np.zeros(1), PA, PA)
    hold(gas, 1.0, 0.3)
    node = (K - 1) * gas.integrated[0, state.HOSE_ENERGY_1] / 1e-5
    assert node == pytest.approx(565220.8, rel=1e-3)  # the chamber behind has risen by 0.1 % meanwhile
    assert gas.books().mass_residual < 1e-10


@limit_of("line_restriction")
def wide_hose_only_adds_its_volume() -> None:
    gas, paper = tank(5e-5, 1e-6, dt=1e-3), tank(6e-5, 1e-6, dt=1e-3)
    gas.cylinders["line_restriction"]["area"], gas.cylinders["line_restriction"]["volume"] = 1e-3, 1e-5
    for each in (gas, paper):
        each.fill(np.zeros(1), 2e5, 2e5)
        hold(each, 1.0, 0.05)
    assert gas.pressures(np.zeros(1)) == pytest.approx(paper.pressures(np.zeros(1)), rel=1e-4)


@limit_of("critical_ratio")
def charging_by_the_iso_ellipse() -> None:
    """A.4.5: C = 1e-8 m^3/(s Pa), b = 0.3, one litre from the atmosphere to 7 bar."""
    gas = tank(1e-3, 5.020208972e-6, dt=1e-4)
    gas.cylinders["critical_ratio"]["ratio"] = 0.3
    gas.fill(np.zeros(1), PA, PA)
    for seconds, pressure in ((0.2, 296316.029918), (0.2, 476867.118919)):
        hold(gas, 1.0, seconds)
        assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(pressure, rel=1e-7)


@limit_of("exhaust_back_pressure")
def silencer_is_in_series_with_the_valve() -> None:
    for ratio, pressure in ((0.5, 350000.0), (1.0, 565220.830689), (2.0, 661091.836534)):
        gas = tank(30.0, 1e-6 * ratio, dt=1e-3)
        gas.world["exhaust_back_pressure"]["area"], gas.world["exhaust_back_pressure"]["volume"] = 1e-6, 2e-5
        gas.fill(np.zeros(1), 7e5, PA)
        hold(gas, -1.0, 2.0)
        y = gas.vector[state.INTEGRATED :]
        assert (K - 1) * y[state.EXHAUST_ENERGY] / 2e-5 == pytest.approx(pressure, rel=2e-4)  # the tank falls by 0.01 %


@limit_of("supply_droop")
def accumulator_falls_isentropically() -> None:
    gas = tank(1e-3, 5e-6, dt=1e-3)
    gas.world["supply_droop"]["volume"] = 1e-3
    gas.fill(np.zeros(1), PA, PA)
    before = gas.vector[state.INTEGRATED + state.SUPPLY_MASS]
    hold(gas, 1.0, 0.07)
    y = gas.vector[state.INTEGRATED :]
    left = y[state.SUPPLY_MASS] / before
    assert gas.books().drawn[0] == pytest.approx(before * (1 - left), rel=1e-12)
    assert (K - 1) * y[state.SUPPLY_ENERGY] / 1e-3 == pytest.approx(7e5 * left**K, rel=1e-6)
    # one stroke of a 32 x 100 at 6 bar, 0.5734 g, costs a litre 0.6661 bar (B18)
    assert 7e5 * (1 - (1 - 0.5734e-3 / before) ** K) == pytest.approx(0.6661e5, abs=6.0)


@limit_of("supply_droop")
def feed_refills_and_lets_nothing_back() -> None:
    gas = tank(1e-4, 5e-6, dt=1e-3)
    gas.world["supply_droop"]["volume"], gas.world["supply_droop"]["conductance"] = 1e-3, 1e-8
    gas.fill(np.zeros(1), PA, PA)
    hold(gas, 1.0, 0.2)
    y = gas.vector[state.INTEGRATED :]
    fed = y[state.FED]
    assert fed > 0.0
    hold(gas, 0.0, 20.0)
    assert (K - 1) * y[state.SUPPLY_ENERGY] / 1e-3 == pytest.approx(7e5, rel=1e-6)
    gas.world["supply_pressure"] = 3e5
    more = y[state.FED]
    hold(gas, 0.0, 1.0)
    assert y[state.FED] == more


@limit_of("supply_regulator")
def droops_in_proportion_to_flow_and_recovers() -> None:
    gas = tank(1.0, 2e-6, dt=1e-3)
    gas.world["supply_regulator"]["droop"], gas.world["supply_regulator"]["time_constant"] = 2e7, 0.05
    gas.fill(np.zeros(1), PA, PA)
    hold(gas, 1.0, 1.0)
    choked = nozzle.mass_flow(2e-6, 1.0, 293.15, 0.0, K, R)
    regulated = 7e5 / (1 + 2e7 * choked)
    held = gas.vector[state.INTEGRATED + state.SHARED + state.REMEMBERED + state.HELD]
    assert 7e5 - 2e7 * held == pytest.approx(regulated, rel=1e-6)
    hold(gas, 0.0, 1.0)
    held = gas.vector[state.INTEGRATED + state.SHARED + state.REMEMBERED + state.HELD]
    assert 2e7 * held == pytest.approx(0.0, abs=1e-3)


@limit_of("supply_regulator")
def sticks_by_half_its_hysteresis() -> None:
    gas = tank(1.0, 2e-6, dt=1e-3)
    gas.world["supply_regulator"]["droop"], gas.world["supply_regulator"]["hysteresis"] = 2e7, 2e4
    gas.fill(np.zeros(1), PA, PA)
    hold(gas, 1.0, 0.5)
    hold(gas, 0.0, 0.5)
    held = gas.vector[state.INTEGRATED + state.SHARED + state.REMEMBERED + state.HELD]
    assert 2e7 * held == pytest.approx(1e4, rel=1e-9)


@limit_of("end_cushioning")
def needle_decides_near_the_end_and_only_outwards() -> None:
    for x, area in ((0.004, 2e-7), (0.03, 5e-6)):
        gas = bench(dt=1e-5, p_1=5e5, p_2=3e5, x=x, dead=5e-6)
        gas.cylinders["end_cushioning"]["length"], gas.cylinders["end_cushioning"]["area"] = 0.01, 2e-7
        gas.fill(np.array([x]), 5e5, 3e5)
        before = gas.integrated[0, state.MASS_1]
        hold(gas, -1.0, 1e-5, x)
        out = (before - gas.integrated[0, state.MASS_1]) / 1e-5
        assert out == pytest.approx(nozzle.mass_flow(area, 5e5, 293.15, PA, K, R), rel=5e-3)
        before = gas.integrated[0, state.MASS_1]
        hold(gas, 1.0, 1e-5, x)
        into = (gas.integrated[0, state.MASS_1] - before) / 1e-5
        assert into == pytest.approx(nozzle.mass_flow(5e-6, 7e5, 293.15, 5e5, K, R), rel=5e-3)


@limit_of("end_cushioning")
def needle_and_valve_are_two_nozzles_behind_each_other() -> None:
    for share in (0.2, 0.5, 1.0, 2.0):
        for p_down, within in ((0.1e5, 0.05), (2e5, 0.05), (4e5, 0.12)):
            found = nozzle.mass_flow(end_cushioning.outlet(_Cushion(0.01, share * 5e-6), 5e-6, 0.004), 5e5, 293.15, p_down, K, R)

            def lacking(middle: float, share: float = share, p_down: float = p_down) -> float:
                into = nozzle.mass_flow(share * 5e-6, 5e5, 293.15, middle, K, R)
                return float(into - nozzle.mass_flow(5e-6, middle, 293.15, p_down, K, R))

            middle = brentq(lacking, p_down, 5e5)
            assert found == pytest.approx(nozzle.mass_flow(share * 5e-6, 5e5, 293.15, middle, K, R), rel=within)


@limit_of("end_cushioning")
def none_throttles_nothing_beyond_the_ends_either() -> None:
    for x in (-5e-4, 0.0, 0.1, 0.1005):
        ends = []
        for leak in (0.0, 1e-16):
            gas = bench(dt=1e-3, p_1=5e5, p_2=5e5, x=x, dead=5e-6)
            gas.cylinders["piston_leakage"]["area"] = leak
            gas.fill(np.array([x]), 5e5, 5e5)
            hold(gas, 1.0 if x > 0.05 else -1.0, 1e-3, x)
            ends.append(gas.integrated[0, [state.MASS_1, state.MASS_2]].copy())
        np.testing.assert_allclose(ends[1], ends[0], rtol=1e-9)


@limit_of("transmission_compliance")
def gas_and_mount_are_springs_in_series() -> None:
    ends = []
    for step in (-1e-5, 1e-5):
        gas = bench()
        gas.cylinders["transmission_compliance"]["stiffness"] = 1e5
        gas.fill(np.array([0.05]), 5e5, 565237.727273)
        ends.append(drive(gas, np.linspace(0.05, 0.05 + step, 11))[-1, 4])
    assert (ends[0] - ends[1]) / 2e-5 == pytest.approx(1 / (1 / 22198.067690 + 1 / 1e5), rel=1e-4)


@limit_of("transmission_compliance")
def drag_on_the_piston_comes_through_the_mount() -> None:
    forces = []
    for stiffness in (0.0, 1e7):
        gas = bench(dead=1e-2)
        gas.cylinders["transmission_compliance"]["stiffness"] = stiffness
        gas.cylinders["viscous_friction"]["coefficient"] = 200.0
        gas.cylinders["return_spring"]["stiffness"] = 500.0
        gas.fill(np.array([0.05]), PA, PA)
        forces.append(drive(gas, 0.05 + 0.1 * 1e-3 * np.arange(200, dtype=float))[-1, 4])
    assert forces[0] == pytest.approx(-20.0 - 500.0 * 0.0699, rel=0.01)
    assert forces[1] == pytest.approx(forces[0], rel=5e-3)


@limit_of("backlash")
def joint_is_free_over_the_whole_gap_and_no_more() -> None:
    gas = bench()
    gas.cylinders["backlash"]["gap"] = 1e-3
    gas.fill(np.array([0.05]), 5e5, 565237.727273)
    found = drive(gas, np.concatenate([np.linspace(0.05, 0.0495, 50), np.linspace(0.0495, 0.0505, 100)]))
    assert np.abs(found[:, 4]).max() < 1e-6
    assert found[:, 0] == pytest.approx(5e5, rel=1e-8)
    beyond = drive(gas, np.linspace(0.0505, 0.0510, 50))
    assert beyond[-1, 4] == pytest.approx(-22198.0 * 0.5e-3 / (1 + 22198.0 / 1e6), rel=0.02)


@limit_of("coulomb_friction")
def stops_after_the_distance_that_its_work_allows() -> None:
    found = slide(contact(coulomb_friction={"force": 12.0}), 10.0, 0.5, nothing, 1.0, 1e-4)
    assert found[-1, 1] == pytest.approx(0.0, abs=1e-9)
    assert found[-1, 0] == pytest.approx(10.0 * 0.5**2 / (2 * 12.0), rel=5e-4)


@limit_of("viscous_friction")
def speed_fades_exponentially() -> None:
    found = slide(contact(viscous_friction={"coefficient": 40.0}), 10.0, 0.5, nothing, 0.5, 1e-5)
    assert found[-1, 1] == pytest.approx(0.5 * math.exp(-2.0), rel=5e-5)


@limit_of("quadratic_drag")
def speed_fades_hyperbolically() -> None:
    for v in (0.5, -0.5):
        found = slide(contact(quadratic_drag={"coefficient": 100.0}), 10.0, v, nothing, 0.4, 1e-5)
        assert found[-1, 1] == pytest.approx(v / (1 + 100.0 * 0.5 * 0.4 / 10.0), rel=5e-5)


@limit_of("return_spring")
def swings_about_its_rest() -> None:
    joint = contact(return_spring={"stiffness": 400.0, "rest": 0.02})
    half = math.pi * math.sqrt(4.0 / 400.0)
    found = slide(joint, 4.0, 0.0, nothing, half, half / 20000, q=0.05)
    assert found[-1, 0] == pytest.approx(-0.01, abs=1e-6)


LUGRE = {
    "coulomb_friction": {"force": 15.0},
    "stribeck_friction": {"breakaway": 25.0, "velocity": 0.02},
    "viscous_friction": {"coefficient": 40.0},
}
LUGRE_TABLE = ((1e-4, 25.003750003), (1e-3, 25.015031224), (0.01, 23.188007831), (0.05, 17.019304541), (0.2, 23.0))


def steady_resistance(joint: NDArray[np.void], v: float) -> float:
    """Return what a joint meets after sliding at v for long [N]."""
    j, z = joint[0], 0.0
    level = joint_dry_level(j, Motion(0.0, v, z, 0.0, 0.0))
    for _ in range(200):
        z = move_bristle(j, z, v, level, 1e-3 / abs(v) * 1e-1)
    return joint_resistance(j, Motion(0.0, v, z, 0.0, 0.0))


@limit_of("stribeck_friction")
def steady_friction_follows_the_stribeck_curve() -> None:
    joint = contact(**LUGRE)
    for v, force in LUGRE_TABLE:
        assert steady_resistance(joint, v) == pytest.approx(force, abs=2e-9)
        assert steady_resistance(joint, -v) == pytest.approx(-force, abs=2e-9)


@limit_of("presliding")
def steady_friction_is_lugres_table() -> None:
    joint = contact(**LUGRE, presliding={"stiffness": 1e5, "damping": 100.0})
    for v, force in LUGRE_TABLE:
        assert steady_resistance(joint, v) == pytest.approx(force, abs=2e-9)


@limit_of("presliding")
def stuck_contact_is_a_spring_of_its_stiffness() -> None:
    joint = contact(coulomb_friction={"force": 15.0}, presliding={"stiffness": 2e4, "damping": 400.0})
    found = slide(joint, 5.0, 0.0, lambda t, q: 1.5 * min(t / 0.2, 1.0), 1.0, 1e-4)
    # LuGre gives 1/(1 - F/Fc) more than the spring alone at slow loading: x = -(Fc/s0) log(1 - F/Fc)
    assert found[-1, 0] == pytest.approx(-15.0 / 2e4 * math.log(1 - 0.1), rel=5e-3)


@limit_of("presliding")
def a_contact_that_slides_is_not_damped() -> None:
    """Turning round at speed takes no more than the dry level, however damped the contact is while it sticks."""
    joint = contact(coulomb_friction={"force": 15.0}, presliding={"stiffness": 2e4, "damping": 400.0})[0]
    for v in (0.1, 0.3, 1.0):
        assert abs(dry_force(joint, -15.0 / 2e4, v, 15.0)) <= 15.0 * (1.0 + 1e-6)
    assert dry_force(joint, 0.0, 1e-4, 15.0) == pytest.approx(400.0 * 1e-4, rel=1e-3)


@limit_of("pressure_dependent_friction")
def level_is_the_area_times_both_gauge_pressures() -> None:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6)
    c["pressure_dependent_friction"]["coefficient"] = 2e-5
    assert dry_level(c[0], Motion(0.0, 0.1, 0.0, 4e5, 1e5)) == pytest.approx(10.0)
    assert dry_level(c[0], Motion(0.0, 0.1, 0.0, -5e4, 1e5)) == pytest.approx(2.0)
    gas = bench(dead=1.0)
    gas.cylinders["pressure_dependent_friction"]["coefficient"] = 2e-5
    gas.fill(np.array([0.05]), 5e5, 2e5)
    path = 0.05 + 0.01 * np.concatenate([np.linspace(0, 1, 100), np.linspace(1, 0, 100)])
    force = drive(gas, path)[:, 4]
    assert force[150] - force[50] == pytest.approx(2 * 2e-5 * (7e5 - 2 * PA), rel=1e-3)


@limit_of("asymmetric_friction")
def each_direction_meets_its_own_friction() -> None:
    joint = contact(asymmetric_friction={"forward": 20.0, "backward": 8.0})
    for v, force in ((0.3, 20.0), (-0.3, 8.0)):
        found = slide(joint.copy(), 10.0, v, nothing, 1.0, 1e-4)
        assert abs(found[-1, 0]) == pytest.approx(10.0 * 0.3**2 / (2 * force), rel=2e-3)
    for load, moves in ((15.0, False), (25.0, True), (-7.0, False), (-9.0, True)):
        found = slide(joint.copy(), 10.0, 0.0, constant(load), 1.0, 1e-3)
        assert bool(abs(found[-1, 0]) > 1e-3) is moves


@limit_of("unknown")
def curve_is_straight_between_its_knots_and_flat_beyond() -> None:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6)["unknown"]
    c["at"] = [0.0, 0.1, 0.3] + [0.3] * 13
    c["values"] = [1.0, 3.0, -1.0] + [-1.0] * 13
    for where, value in ((-1.0, 1.0), (0.0, 1.0), (0.05, 2.0), (0.1, 3.0), (0.2, 1.0), (0.3, -1.0), (9.0, -1.0)):
        assert unknown.acting(c[0], 0, where, 5.0, 0.0, 0.0) == pytest.approx(value)
    c["depends_on"] = 4.0
    assert unknown.acting(c[0], 0, 9.0, 9.0, 5.05, 5.0) == pytest.approx(2.0)
    assert unknown.acting(c[0], 1, 9.0, 9.0, 5.05, 5.0) == 0.0


@limit_of("unknown")
def flow_into_a_closed_chamber_is_an_entry_of_the_books() -> None:
    gas = tank(1e-4, 5e-6, dt=1e-3)
    c = gas.cylinders["unknown"]
    c["acts"], c["at"], c["values"] = 2.0, [0.0] + [1.0] * 15, 1e-5
    gas.fill(np.zeros(1), 3e5, 3e5, temperature=320.0)
    mass, energy = gas.integrated[0, [state.MASS_2, state.ENERGY_2]]
    hold(gas, 0.0, 2.0)
    assert gas.integrated[0, state.MASS_2] == pytest.approx(mass + 2e-5, rel=1e-12)
    assert gas.integrated[0, state.ENERGY_2] == pytest.approx(energy + 2e-5 * CP * 293.15, rel=1e-12)
    assert gas.books().mass_residual < 1e-10 and gas.books().energy_residual < 1e-10


@limit_of("sensor_bias")
def reads_more_by_the_bias() -> None:
    assert sensor_bias.read(np.array([1.0, 2.0]), np.zeros(2), 0.5) == pytest.approx([1.5, 2.5])


@limit_of("sensor_scale")
def reads_in_proportion() -> None:
    assert sensor_scale.read(np.array([1.0, -2.0]), np.zeros(2), 1.1) == pytest.approx([1.1, -2.2])


@limit_of("sensor_delay")
def reads_what_was() -> None:
    time = np.arange(0.0, 1.0, 1e-3)
    late = sensor_delay.read(np.sin(7 * time), time, 0.0155)
    assert late[20:] == pytest.approx(np.sin(7 * (time[20:] - 0.0155)), abs=1e-5)
    assert late[0] == 0.0
