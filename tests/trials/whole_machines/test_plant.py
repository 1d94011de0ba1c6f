"""The whole machine's equations against closed forms and published numbers; nothing here knows the simulator under test."""

from __future__ import annotations

import math

import numpy as np
import pytest

from exo_sim.trials.whole_machines.draw import build
from exo_sim.trials.whole_machines.excitation import Program
from exo_sim.trials.whole_machines.friction_laws import ELASTOPLASTIC, LIPS, LUGRE, SECANT, contact, level
from exo_sim.trials.whole_machines.gas_laws import (
    CLEARANCE,
    ELLIPSE,
    GAP,
    NOZZLE,
    POROUS,
    SHARP,
    STIRRED,
    conductance,
    flow_factor,
    leak,
    orifice,
)
from exo_sim.trials.whole_machines.loop import FED, GAINS, MEMO, POSITION
from exo_sim.trials.whole_machines.machine import Machine
from exo_sim.trials.whole_machines.machine_run import Run, Ticks, advance
from exo_sim.trials.whole_machines.makes import MAKES
from exo_sim.trials.whole_machines.plant import (
    LINE_1,
    LINE_2,
    N1,
    N2,
    NT,
    NX,
    QD,
    SPOOL,
    STATES,
    U1,
    U2,
    UT,
    UX,
    W1,
    W2,
    Q,
    at_rest,
    transmission,
    valve_path,
)
from exo_sim.trials.whole_machines.published_cylinders import hose_conductance, throat_area

BENCH = {
    "area_1": 8.04e-4, "area_2": 6.91e-4, "stroke": 0.1, "dead_1": 1.2e-5, "dead_2": 1.2e-5, "piston_mass": 0.1, "inertia": 3.0,
    "supply": 6e5, "valve_area": 2.5e-6, "stop_stiffness": 3e5, "stop_damping": 400.0,
}  # fmt: skip
THROAT = (2 / 2.4) ** 3.5


def run(
    m: Machine, seconds: float, command: float | np.ndarray = 0.0, p1: float = 3e5, p2: float = 3.4e5, x: float = 0.05, v: float = 0.0,
    dt: float | None = None, rate: float = 1000,
) -> Run:  # fmt: skip
    dt = dt or m.step()
    n = round(seconds * rate)
    record = m.packed()
    y = np.zeros(STATES)
    at_rest(y, x, p1, p2, record[0])
    y[QD] = v
    feed = np.broadcast_to(np.asarray(command, float), n).copy()
    plan = Program(np.full(n, FED, np.int64), np.zeros(n), np.zeros(n), feed)
    steps = np.full(n, round(1 / rate / dt), np.int64)
    return advance(m, y, np.zeros(MEMO), Ticks(steps, 1, dt), plan, np.zeros(GAINS), np.zeros(n), keep=True)


def test_nozzle_and_ellipse_choke_where_they_say_and_meet_at_equal_pressures():
    for law, b in ((ELLIPSE, 0.3), (NOZZLE, 0.3), (NOZZLE, THROAT)):
        assert flow_factor(b - 1e-6, law, b, 0.5, 1.4) == 1.0
        assert flow_factor(b + 1e-6, law, b, 0.5, 1.4) == pytest.approx(1.0, abs=1e-4)
        assert flow_factor(1.0, law, b, 0.5, 1.4) == 0.0


def test_the_nozzle_is_de_saint_venant_and_wantzel():
    r = 0.8
    ideal = math.sqrt(2 * 1.4 / 0.4 * (r ** (2 / 1.4) - r ** (2.4 / 1.4))) / (math.sqrt(1.4) * (2 / 2.4) ** 3)
    assert flow_factor(r, NOZZLE, THROAT, 0.5, 1.4) == pytest.approx(ideal, rel=1e-9)


def test_choked_flow_of_air_has_the_published_factor():
    # 0.0404 kg/s per m2, Pa and root kelvin
    p = Machine().packed()[0]
    assert orifice(1e-6, 7e5, 293.15, 1e5, 293.15, ELLIPSE, 0.3, 0.5, 0.0, p) == pytest.approx(
        1e-6 * 7e5 * 0.040418 / 293.15**0.5, rel=1e-4
    )


def test_leaks_are_what_they_say():
    p = Machine().packed()[0]
    assert leak(1e-16, 3e5, 293.15, 2e5, 293.15, GAP, 0.0, 1.0, p) == pytest.approx(1e-16 * 5e10)
    w = leak(1e-15, 6e5, 293.15, 1e5, 293.15, POROUS, 1e20, 1.0, p)
    assert w / 1e-15 + 1e20 * w * w == pytest.approx(36e10 - 1e10, rel=1e-9)
    assert leak(1e-15, 1e5, 293.15, 6e5, 293.15, POROUS, 1e20, 1.0, p) == pytest.approx(-w)


def test_a_sharp_edge_passes_more_the_deeper_it_blows_and_never_chokes():
    slow = flow_factor(0.97, SHARP, 0.0, 0.5, 1.4) / flow_factor(0.97, NOZZLE, THROAT, 0.5, 1.4)
    assert flow_factor(1e-9, SHARP, 0.0, 0.5, 1.4) == pytest.approx(1.0)
    assert slow == pytest.approx(0.61 / 0.84, rel=0.02)
    factors = [flow_factor(r, SHARP, 0.0, 0.5, 1.4) for r in np.linspace(0.0, 1.0, 101)]
    assert np.all(np.diff(factors) < 0) and factors[-1] == 0.0


def test_a_laminar_part_is_a_straight_line_from_the_ellipse_to_nothing():
    at = [flow_factor(r, ELLIPSE, 0.3, 0.5, 1.4, 0.95) for r in (0.95, 0.975, 1.0)]
    assert at[0] == flow_factor(0.95, ELLIPSE, 0.3, 0.5, 1.4)
    assert at[1] == pytest.approx(0.5 * at[0]) and at[2] == 0.0
    m = Machine({"flow_law": ELLIPSE, "flow_b": 0.3, "flow_laminar": 0.95})
    assert valve_path(1e-6, 4e5, 293.15, 3.9e5, 293.15, m.packed()[0]) == pytest.approx(
        0.5 * valve_path(1e-6, 4e5, 293.15, 3.8e5, 293.15, m.packed()[0])
    )


def test_a_clearance_is_a_gap_until_it_turns_turbulent():
    p = Machine().packed()[0]
    turning = 1e-16 * 7e10
    assert leak(1e-16, 3e5, 293.15, 2e5, 293.15, CLEARANCE, 0.0, turning, p) == pytest.approx(1e-16 * 5e10)
    assert leak(1e-16, 4e5, 293.15, 3e5, 293.15, CLEARANCE, 0.0, turning, p) == pytest.approx(turning)
    w = leak(1e-16, 1e5, 293.15, 6e5, 293.15, CLEARANCE, 0.0, turning, p)
    assert (-w / turning) ** 1.75 == pytest.approx(35e10 / 7e10)


def test_what_a_piston_stirs_takes_more_heat_and_a_resting_one_some():
    still, moving, fast = (conductance(STIRRED, 0.0, 40.0, 1e-3, 0.1, 0.05, 4e5, 293.15, v) for v in (0.0, 0.3, -0.63))
    assert moving == pytest.approx(40.0 * (1e-3 + 0.1 * 0.05))
    assert fast / moving == pytest.approx(2.0**0.7)
    assert 0.1 < still / moving < 0.25


def test_a_secant_is_flat_at_rest_and_a_rod_has_a_lip_of_its_own():
    p = Machine({"coulomb": 10.0, "breakaway_excess": 8.0, "stribeck_speed": 0.02, "stribeck_law": SECANT}).packed()[0]
    dry = [level(v, 0.0, 1e5, 1e5, 0.0, 0.0, p) for v in (1e-5, 0.02, 10.0)]
    assert dry == pytest.approx([18.0, 10.0 + 8.0 / math.cosh(1.0), 10.0], abs=1e-4)
    areas = {"area_1": 4e-4, "area_2": 3e-4, "pressure_law": LIPS, "pressure_friction": 1e-5, "ambient": 1e5}
    p = Machine(areas).packed()[0]  # a rod half as thick as the piston
    assert level(0.1, 0.0, 3e5, 1e5, 0.0, 0.0, p) == pytest.approx(2.0)
    assert level(0.1, 0.0, 1e5, 3e5, 0.0, 0.0, p) == pytest.approx(3.0)


def test_an_uneven_spool_opens_faster_than_its_spring_closes():
    m = Machine({**BENCH, "inertia": 1e9, "lag": 5e-3, "lag_back": 1e-2})
    u = np.where(np.arange(200) < 100, -0.5, 0.0)
    spool = run(m, 0.2, u).states[:, SPOOL]
    assert spool[5] == pytest.approx(-0.5 * (1 - math.exp(-1)), rel=1e-3)
    assert spool[110] == pytest.approx(spool[100] * math.exp(-1), rel=1e-3)


@pytest.mark.parametrize("make", ["O", "P"])
@pytest.mark.parametrize("seed", [1, 3, 7])
def test_books_of_drawn_machines_close_where_nothing_leaves(make, seed):
    """A drawn machine between a tank that nothing fills and an exhaust that is shut: gas goes round and none is lost."""
    drawn = build(MAKES[make], "whole", np.random.default_rng(seed)).machine
    shut = {"tank_volume": 2e-3, "tank_feed": 0.0, "tank_heat": 0.0, "exhaust_area": 1e-30, "exhaust_volume": 1e-3, "leak_1": 0.0,
            "leak_2": 0.0, "heat_conductance": 0.0, "heat_coefficient": 0.0, "hose_heat": 0.0, "regulator_droop": 0.0}  # fmt: skip
    seals = {"coulomb": 0.0, "breakaway_excess": 0.0, "viscous": 0.0, "pressure_friction": 0.0, "damping": 0.0}
    m = drawn.with_(**shut, **seals)
    middle = 0.0 if m["lever"] else 0.5 * m["stroke"] - m["zero"]
    u = 0.5 * np.cos(2 * np.pi * 8.0 * np.arange(250) / 1000)
    p2 = (3.2e5 * m["area_1"] - m["ambient"] * (m["area_1"] - m["area_2"])) / m["area_2"]
    one = run(m, 0.25, u, p1=3.2e5, p2=p2, x=middle)
    s = one.states
    gas, energy = s[:, N1] + s[:, N2] + s[:, NX] + s[:, NT], s[:, U1] + s[:, U2] + s[:, UX] + s[:, UT]
    if m["hose_kind"] > 0:
        cells = 1 if m["hose_kind"] == 1.0 else 3
        for line in (LINE_1, LINE_2):
            gas = gas + s[:, line : line + 2 * cells : 2].sum(1)
            energy = energy + s[:, line + 1 : line + 2 * cells : 2].sum(1)
    passed = np.ptp(s[:, NT])
    assert passed > 1e-2 * s[0, N1] and np.ptp(gas) < 1e-10 * passed
    if m["hose_kind"] != 2.0:  # gas that flows in a line has energy of motion as well
        slope = np.array([transmission(q, m.packed()[0])[1] for q in s[:, Q]])
        moving = 0.5 * (m["inertia"] + m["piston_mass"] * (slope**2 if m["lever"] else 1.0)) * s[:, QD] ** 2
        weight = m["gravity"] * (np.sin(s[:, Q]) if m["lever"] else s[:, Q])
        x = one.at_samples("piston")
        assert 0.0 < x.min() < x.max() < m["stroke"]  # a stop would take some
        spring = 0.5 * m["spring"] * (x - m["spring_rest"]) ** 2
        total = energy + moving + weight + spring + m["ambient"] * (m["area_1"] - m["area_2"]) * x
        assert np.ptp(total) < 1e-4 * (np.ptp(s[:, UT]) + np.ptp(moving))


def test_a_hose_of_four_millimetres_and_a_metre():
    sonic, ratio = hose_conductance(4e-3, 1.0)
    assert sonic == pytest.approx(1.2e-8, rel=0.03) and ratio == pytest.approx(0.355, abs=0.01)
    assert throat_area(sonic) < math.pi / 4 * 16e-6


def test_a_closed_frictionless_machine_keeps_its_energy():
    m = Machine(BENCH)
    one = run(m, 1.0, v=0.4)
    s = one.states
    ambient = m["ambient"] * (m["area_1"] - m["area_2"]) * one.at_samples("piston")
    energy = s[:, U1] + s[:, U2] + 0.5 * 3.1 * s[:, QD] ** 2 + ambient
    swing = np.ptp(s[:, QD]) ** 2 * 3.1 / 8
    assert np.ptp(energy) < 1e-6 * swing
    assert np.ptp(s[:, N1]) < 1e-12 and np.ptp(s[:, N2]) < 1e-12


def test_a_sealed_chamber_follows_the_isentrope():
    one = run(Machine(BENCH), 0.5, v=0.5)
    volume = BENCH["dead_1"] + BENCH["area_1"] * one.at_samples("piston")
    product = one.at_samples("pressure_1") * volume**1.4
    assert np.ptp(product) < 1e-6 * product[0]


@pytest.mark.parametrize(
    "parts",
    [
        {},
        {"hose_kind": 1.0, "hose_area": 5e-6, "hose_volume": 8e-6},
        {"hose_kind": 2.0, "hose_bore": 4e-3, "hose_length": 1.0},
        {"exhaust_area": 3e-6, "tank_volume": 5e-4, "tank_feed": 1e-9, "leak_piston": 2e-8},
    ],
)
def test_no_gas_is_lost_between_the_volumes(parts):
    m = Machine({**BENCH, **parts})
    u = 0.6 * np.sin(2 * np.pi * 1.3 * np.arange(1000) / 1000)
    s = run(m, 1.0, u).states
    inside = (
        s[:, N1]
        + s[:, N2]
        + s[:, LINE_1 : LINE_1 + 6 : 2].sum(1) * (m["hose_kind"] > 0)
        + s[:, LINE_2 : LINE_2 + 6 : 2].sum(1) * (m["hose_kind"] > 0)
    )
    inside = inside + s[:, NX] * (m["exhaust_area"] > 0) + s[:, NT] * (m["tank_volume"] > 0)
    closed = run(m.with_(valve_area=0.0, exhaust_area=0.0, tank_feed=0.0), 0.3, 0.0, v=0.2).states
    held = closed[:, N1] + closed[:, N2]
    if m["hose_kind"] > 0:
        held = held + closed[:, LINE_1 : LINE_1 + 6 : 2].sum(1) + closed[:, LINE_2 : LINE_2 + 6 : 2].sum(1)
    assert np.ptp(held) < 1e-9 * held[0]
    assert np.ptp(inside) > 1e-3 * inside[0]  # while the open machine breathes


def test_third_order_in_the_step():
    m = Machine({**BENCH, "lag": 6e-3, "heat_conductance": 0.3, "viscous": 60.0})
    u = 0.15 + 0.1 * np.sin(2 * np.pi * 3 * np.arange(200) / 1000)
    fine = run(m, 0.2, u, dt=1e-6).at_samples("pressure_1")
    errors = [abs(run(m, 0.2, u, dt=dt).at_samples("pressure_1") - fine).max() for dt in (2e-4, 1e-4, 5e-5)]
    assert errors[0] / errors[1] > 5.5 and errors[1] / errors[2] > 5.5


def test_a_bristle_settles_at_the_level_of_friction():
    values = {"coulomb": 12.0, "breakaway_excess": 8.0, "stribeck_speed": 0.02, "stribeck_exponent": 0.7, "bristle_stiffness": 2e5}
    for law in (LUGRE, ELASTOPLASTIC):
        p = Machine({**values, "contact_law": law}).packed()[0]
        v, z = 0.03, 0.0
        sliding = level(v, 0.0, 1e5, 1e5, 0.0, 0.0, p)
        for _ in range(20000):
            force, rate = contact(v, z, sliding, p)
            z += 1e-6 * rate
        assert sliding == pytest.approx(12 + 8 * math.exp(-((0.03 / 0.02) ** 0.7)))
        assert force == pytest.approx(sliding, rel=1e-3)


def test_an_elasto_plastic_contact_does_not_creep_and_lugre_does():
    p = {law: Machine({"coulomb": 12.0, "contact_law": law, "bristle_stiffness": 2e5}).packed()[0] for law in (LUGRE, ELASTOPLASTIC)}
    z = 0.5 * 12.0 / 2e5
    assert contact(1e-3, z, 12.0, p[ELASTOPLASTIC])[1] == 1e-3
    assert contact(1e-3, z, 12.0, p[LUGRE])[1] == pytest.approx(0.5e-3)


def test_a_wall_takes_what_the_gas_gives():
    m = Machine({**BENCH, "heat_conductance": 2.0, "wall_capacity": 3.0, "inertia": 1e9})
    one = run(m, 3.0, p1=6e5, x=0.05)
    s = one.states
    s0 = s[:, U1] + s[:, U2]
    gone = np.ptp(s0)
    assert gone > 0 and np.ptp(s0 + 3.0 * (s[:, W1] + s[:, W2])) < 5e-6 * s0[0]


def test_a_tank_that_is_not_fed_falls_by_what_is_drawn():
    m = Machine({**BENCH, "tank_volume": 3e-4, "inertia": 1e9})
    s = run(m, 0.5, 0.5, p1=1.5e5).states
    gained = s[-1, N1] - s[0, N1]
    assert s[0, NT] - s[-1, NT] == pytest.approx(gained, rel=1e-9)
    assert s[-1, UT] < s[0, UT]


def test_position_control_reaches_its_goal():
    m = Machine({**BENCH, "coulomb": 5.0, "viscous": 100.0})
    n = 2000
    plan = Program(np.full(n, POSITION, np.int64), np.full(n, 0.07), np.zeros(n), np.zeros(n))
    gains = np.zeros(GAINS)
    gains[:3] = 8.0, 0.2, 1e-3
    y = np.zeros(STATES)
    at_rest(y, 0.05, 3e5, 3.4e5, m.packed()[0])
    one = advance(m, y, np.zeros(MEMO), Ticks(np.full(n, 50, np.int64), 1, 2e-5), plan, gains, np.zeros(n))
    assert one.at_samples("position")[-1] == pytest.approx(0.07, abs=2e-3)
