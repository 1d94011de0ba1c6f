"""The true machine against closed forms and published numbers; nothing here knows the simulator under test."""

from __future__ import annotations

import math

import numpy as np
import pytest

from exo_sim.trials.truth.drive import advance
from exo_sim.trials.truth.excitation import Program
from exo_sim.trials.truth.flows import mass_flow, porous_flow
from exo_sim.trials.truth.friction import friction_level
from exo_sim.trials.truth.machine import Machine
from exo_sim.trials.truth.plant import rates
from exo_sim.trials.truth.state import M1, M2, ML1, ML2, STATES, VP, XP, at_rest

AMBIENT = 101325.0
#: A rigid litre on side 1: nothing moves, because what moves is too heavy.
LITRE = {
    "area_1": 8.042477193e-4, "area_2": 6.911503838e-4, "stroke": 0.2, "dead_1": 1e-3, "dead_2": 1e-3, "load_mass": 1e9,
    "laminar_zone": 1e-5,
}  # fmt: skip
GAINS = np.zeros(4)


def run(machine, p1, p2, seconds, command=0.0, x=0.0, v=0.0, dt=5e-5, rate=1000, feed=None):
    record = machine.packed()
    y = at_rest(x, p1, p2, record[0])
    y[VP] = v
    n = round(seconds * rate) + 1
    feed = np.full(n, command) if feed is None else feed
    plan = Program(np.zeros(n, np.int64), np.zeros(n), np.zeros(n), feed)
    ticks = np.full(n, round(1 / rate / dt), np.int64)
    return advance(machine, y, np.zeros(4), 0.0, ticks, dt, plan, GAINS, np.zeros(n), keep=True)


def test_choked_flow_of_the_published_cases():
    flow = mass_flow(5e-6, 7e5, 293.15, 1e5, 293.15, 0.5282817877, 1e-6, 1.4, 287.05)
    assert flow == pytest.approx(8.261608278286e-3, rel=1e-9)
    assert mass_flow(5e-6, 17.2e5, 293.0, 1e5, 293.0, 0.52828, 1e-6, 1.4, 287.05) == pytest.approx(
        2.030514733802e-2, rel=1e-9
    )


@pytest.mark.parametrize("r, share", [(0.6, 0.9035), (0.8, 0.6999), (0.9, 0.5151)])
def test_ellipse_of_iso_6358(r, share):
    choked = mass_flow(5e-6, 7e5, 293.15, 1e5, 293.15, 0.3, 1e-9, 1.4, 287.05)
    assert mass_flow(5e-6, 7e5, 293.15, 7e5 * r, 293.15, 0.3, 1e-9, 1.4, 287.05) / choked == pytest.approx(
        share, abs=6e-5
    )


def test_flow_turns_round_and_stops_at_equal_pressures():
    there = mass_flow(3e-6, 5e5, 293.15, 4e5, 293.15, 0.5, 3e-3, 1.4, 287.05)
    assert mass_flow(3e-6, 4e5, 293.15, 5e5, 293.15, 0.5, 3e-3, 1.4, 287.05) == -there
    assert mass_flow(3e-6, 5e5, 293.15, 5e5, 293.15, 0.5, 3e-3, 1.4, 287.05) == 0.0


@pytest.mark.parametrize("t, pressure, temperature", [
    (0.1, 609965.541527, 281.84235491), (0.2, 532924.803621, 271.17656418), (0.5, 360780.862692, 242.57483361),
    (0.8, 249325.449922, 218.27058109),
])  # fmt: skip
def test_adiabatic_blow_down(t, pressure, temperature):
    log = run(Machine({**LITRE, "leak_out_area_1": 5e-6}), 7e5, AMBIENT, 0.8).log
    row = round(t * 1000)
    assert log["pressure_1"][row] == pytest.approx(pressure, rel=2e-6)
    assert log["temperature_1"][row] == pytest.approx(temperature, rel=2e-6)


def test_isothermal_blow_down():
    machine = Machine({**LITRE, "leak_out_area_1": 5e-6, "heat_conductance": 2e4})
    log = run(machine, 7e5, AMBIENT, 0.8, dt=1e-5).log
    expected = 7e5 * np.exp(-log["time"][[100, 500, 800]] / 1.006899189111)
    assert log["pressure_1"][[100, 500, 800]] == pytest.approx(expected, rel=4e-4)


def test_charging_through_the_ellipse():
    machine = Machine({**LITRE, "valve_area": 5.020208972e-6, "choked_ratio": 0.3})
    log = run(machine, AMBIENT, AMBIENT, 0.4, command=1.0).log
    assert log["pressure_1"][200] == pytest.approx(296316.029918, rel=1e-5)
    assert log["pressure_1"][400] == pytest.approx(476867.118919, rel=2e-5)


def test_closed_cylinder_settles_between_series_orifices():
    machine = Machine({**LITRE, "dead_1": 5e-5, "dead_2": 5e-5, "null_leak": 2e-6})
    assert run(machine, 3e5, 3e5, 2.0).log["pressure_1"][-1] == pytest.approx(565220.83, rel=2e-3)


@pytest.mark.parametrize("wt, size, degrees", [(0.1, 1.004741, 2.259), (1.0, 1.216553, 9.462), (10.0, 1.396601, 1.625)])
def test_sealed_chamber_breathes_with_wall_heat(wt, size, degrees):
    """Complex stiffness n(jw) = (1 + k jw tau)/(1 + jw tau) of a sealed chamber with a constant wall conductance."""
    omega, mass, middle = 2 * math.pi, 1e9, 0.1
    base = Machine(
        {**LITRE, "dead_1": 1e-4, "load_mass": mass, "spring_stiffness": mass * omega**2, "spring_rest": middle}
    )
    volume = 1e-4 + base["area_1"] * middle
    capacity = 4e5 * volume / (287.05 * 293.15) * 287.05 / 0.4
    machine = base.with_(heat_conductance=capacity * omega / wt)
    log = run(machine, 4e5, 4e5, 8.0, x=middle, v=1e-4 * omega).log
    rows = slice(-3001, -1)
    wave = np.exp(-1j * omega * log["time"][rows])
    pressure = (log["pressure_1"][rows] / log["pressure_1"][rows].mean() - 1) @ wave
    swept = base["area_1"] * (log["position"][rows] - middle) / volume @ wave
    n = -pressure / swept
    assert abs(n) == pytest.approx(size, rel=2e-3)
    assert math.degrees(np.angle(n)) == pytest.approx(degrees, abs=0.06)


@pytest.mark.parametrize("v, force", [(1e-4, 25.003750003), (1e-3, 25.015031224), (0.01, 23.188007831), (0.05,
17.019304541),
                                      (0.2, 23.0)])  # fmt: skip
def test_lugre_steady_state(v, force):
    machine = Machine({**LITRE, "coulomb": 15.0, "stribeck_breakaway": 25.0, "stribeck_velocity": 0.02})
    assert friction_level(v, 1e5, 1e5, 0.0, machine.packed()[0]) + 40 * v == pytest.approx(force, rel=1e-8)


def test_bristles_settle_on_the_steady_friction():
    machine = Machine(
        {**LITRE, "coulomb": 15.0, "stribeck_breakaway": 25.0, "stribeck_velocity": 0.02, "bristle_stiffness": 1e5}
    )
    # the bristle is the first entry of the second part of the kept state
    bristle = run(machine, AMBIENT, AMBIENT, 0.2, v=0.05).states[:, STATES]
    assert 1e5 * bristle[-1] == pytest.approx(17.019304541 - 2.0, rel=1e-6)


@pytest.mark.parametrize("t, x, v, p1, p2", [
    (0.02, 0.100585706, 0.076012538, 393625.0101, 257901.1381), (0.05, 0.106659294, 0.355211479, 492363.1454,
    221492.8365),
    (0.10, 0.139623232, 0.953209008, 487139.5514, 248755.1729),
])  # fmt: skip
def test_golden_trajectory_of_the_corrected_paper(t, x, v, p1, p2):
    """The nozzle of the paper and the ellipse of ISO 6358 differ by 0.15 % of the choked flow at most."""
    machine = Machine({"area_1": 8.042477193e-4, "area_2": 6.911503838e-4, "stroke": 0.2, "load_mass": 20.0,
     "valve_area": 2e-6,
                       "laminar_zone": 1e-4})  # fmt: skip
    log = run(machine, 3e5, 3e5, 0.1, command=1.0, x=0.1).log
    row = round(t * 1000)
    assert log["position"][row] == pytest.approx(x, rel=2e-4)
    assert log["velocity"][row] == pytest.approx(v, rel=3e-3)
    assert log["pressure_1"][row] == pytest.approx(p1, rel=2e-3)
    assert log["pressure_2"][row] == pytest.approx(p2, rel=2e-3)


def test_piston_leak_equalises_and_keeps_the_gas():
    machine = Machine({**LITRE, "dead_1": 5e-5, "dead_2": 5e-5, "leak_piston_laminar": 2e-15, "heat_conductance": 50.0})
    truth = run(machine, 6e5, 2e5, 6.0)
    mass = truth.states[:, M1] + truth.states[:, M1 + 2]
    assert mass == pytest.approx(mass[0], rel=1e-12)
    assert truth.log["pressure_1"][-1] == pytest.approx(truth.log["pressure_2"][-1], rel=1e-3)


def test_slow_laminar_leak_follows_its_law():
    """Isothermal and sealed: V dP/dt = -a R T (P1^2 - P2^2)."""
    machine = Machine({**LITRE, "leak_piston_laminar": 1e-16, "heat_conductance": 1000.0})
    log = run(machine, 6e5, 2e5, 1.0).log
    volume_1, volume_2 = 1e-3, 1e-3 + machine["area_2"] * 0.2
    flow = 1e-16 * (6e5**2 - 2e5**2) * 287.05 * 293.15
    assert 6e5 - log["pressure_1"][-1] == pytest.approx(flow / volume_1, rel=2e-2)
    assert log["pressure_2"][-1] - 2e5 == pytest.approx(flow / volume_2, rel=2e-2)


@pytest.mark.parametrize("difference", [1e9, 3e11, -2e10])
def test_porous_path_obeys_its_law(difference):
    w = porous_flow(difference, 1e-16, 4e20)
    assert w / 1e-16 + 4e20 * w * abs(w) == pytest.approx(difference, rel=1e-9)


@pytest.mark.parametrize("side, x", [(1, 0.005), (2, 0.195)])
def test_a_needle_holds_back_what_leaves_the_chamber_before_its_line(side, x):
    """The needle sits in the end cap: behind it the line empties freely, and what flows in passes beside it."""
    needle, line = 5e-8, 4e-6
    machine = Machine({**LITRE, "cushion_area": needle, "cushion_length": 0.02, "line_area": line, "line_volume": 1e-5})
    record = machine.packed()[0]
    mass, in_line = (M1, ML1) if side == 1 else (M2, ML2)

    def rate(line_pressure):
        y, out = at_rest(x, 6e5, 6e5, record), np.zeros(STATES)
        y[in_line] *= line_pressure / 6e5
        rates(y, 0.0, 0.0, 0.0, record, out)
        return out[mass]

    ratio = record["leak_ratio"]
    assert rate(1.2e5) == pytest.approx(-mass_flow(needle, 6e5, 293.15, 1.2e5, 293.15, ratio, 1e-5, 1.4, 287.05), rel=1e-3)
    assert rate(7e5) == pytest.approx(mass_flow(line, 7e5, 293.15, 6e5, 293.15, ratio, 1e-5, 1.4, 287.05), rel=1e-3)


def test_atmosphere_on_the_rod_balances():
    record = Machine({**LITRE, "load_mass": 1.0}).packed()
    out = np.empty(STATES)
    force = rates(at_rest(0.1, AMBIENT, AMBIENT, record[0]), 0.0, 0.0, 0.0, record[0], out)[1]
    assert force == pytest.approx(0.0, abs=1e-9)
    assert out[XP] == 0.0


def spool(machine, feed):
    """The spool is not logged: read it off the flow into a large chamber."""
    log = run(
        machine.with_(dead_1=10.0, dead_2=10.0, valve_area=5e-6), AMBIENT, 3e5, (len(feed) - 1) / 1000, feed=feed
    ).log
    flow = np.diff(log["pressure_1"]) * 10.0 / (1.4 * 287.05 * 293.15)
    return flow * 1000 / (5e-6 * 0.0404148996 * 7e5 / math.sqrt(293.15))


def test_command_waits_lags_and_is_limited():
    step = np.where(np.arange(200) >= 50, 0.5, 0.0)
    assert spool(Machine(LITRE), step)[[49, 50]] == pytest.approx([0.0, 0.5], abs=1e-3)
    assert spool(Machine({**LITRE, "delay": 0.010}), step)[[59, 60]] == pytest.approx([0.0, 0.5], abs=1e-3)
    assert spool(Machine({**LITRE, "lag": 0.02}), step)[70] == pytest.approx(0.5 * (1 - math.exp(-20.5 / 20)), rel=5e-3)
    assert spool(Machine({**LITRE, "rate_limit": 5.0}), step)[99] == pytest.approx(0.2475, abs=1e-3)


def test_play_has_the_full_width_between_the_two_directions():
    up_and_down = np.concatenate([np.linspace(0, 0.8, 400), np.linspace(0.8, 0, 400)])
    seen = spool(Machine({**LITRE, "hysteresis": 0.1}), up_and_down)
    assert seen[200] == pytest.approx(up_and_down[200] - 0.05, abs=2e-3)
    assert seen[600] == pytest.approx(up_and_down[600] + 0.05, abs=2e-3)


def test_deadband_stretches_the_rest():
    ramp = np.linspace(0, 1, 500)
    seen = spool(Machine({**LITRE, "deadband": 0.1}), ramp)
    assert seen[[40, 250, 450]] == pytest.approx([0.0, (ramp[250] - 0.1) / 0.9, (ramp[450] - 0.1) / 0.9], abs=2e-3)


def test_halving_the_step_changes_less_than_the_noise():
    machine = Machine({"area_1": 8e-4, "area_2": 7e-4, "stroke": 0.16, "dead_1": 1e-5, "dead_2": 1e-5, "load_mass": 9.0,
                       "valve_area": 2e-6, "coulomb": 15.0, "viscous": 60.0, "heat_conductance": 0.6})  # fmt: skip
    feed = 0.2 * np.sin(2 * np.pi * 1.5 * np.arange(1000) / 1000)
    coarse = run(machine, 4e5, 4.5e5, 0.999, x=0.08, feed=feed, dt=5e-5).log
    fine = run(machine, 4e5, 4.5e5, 0.999, x=0.08, feed=feed, dt=1e-5).log
    assert np.abs(coarse["pressure_1"] - fine["pressure_1"]).max() < 60.0
    assert np.abs(coarse["position"] - fine["position"]).max() < 1e-5
