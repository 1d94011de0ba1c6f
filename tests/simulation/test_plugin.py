"""The plug-in over MuJoCo's model and data: snapshots, neighbours, several cylinders, energy."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from exo_sim.errors import ModelError, RigError
from exo_sim.machine.load import load
from exo_sim.recording.table import Recording
from exo_sim.rig import parse, read
from exo_sim.simulation.plugin import PneumaticPlugin
from exo_sim.simulation.sensors import observe

EVERYTHING = """
[effects.wall_heat_transfer.piston]
conductance = "0.8 W/K"
[effects.moving_wall_temperature.piston]
heat_capacity = "20 J/K"
outside_conductance = "0.1 W/K"
[effects.piston_leakage.piston]
area = "0.02 mm^2"
[effects.external_leakage.piston]
area_1 = "0.02 mm^2"
laminar_2 = "1e-17 kg/(s Pa^2)"
inertial = "1e18 Pa^2 s^2/kg^2"
[effects.valve_null_leakage.piston]
area = "0.05 mm^2"
[effects.valve_deadband.piston]
width = 0.03
[effects.valve_offset.piston]
shift = 0.01
[effects.valve_lag.piston]
time_constant = "5 ms"
delay = "3.3 ms"
[effects.valve_hysteresis.piston]
width = 0.02
[effects.spool_rate_limit.piston]
rate = "100 1/s"
[effects.critical_ratio.piston]
ratio = 0.3
[effects.line_restriction.piston]
area = "8 mm^2"
volume = "10 cm^3"
[effects.exhaust_back_pressure.exhaust]
area = "10 mm^2"
[effects.supply_droop.supply]
volume = "1 L"
conductance = "1e-7 kg/(s Pa)"
[effects.supply_regulator.supply]
droop = "1e7 Pa s/kg"
time_constant = "0.05 s"
hysteresis = "5000 Pa"
[effects.end_cushioning.piston]
length = "10 mm"
area = "0.3 mm^2"
[effects.asymmetric_friction.piston]
forward = "12 N"
backward = "11 N"
[effects.stribeck_friction.piston]
breakaway = "15 N"
velocity = "0.02 m/s"
[effects.viscous_friction.piston]
coefficient = "40 N s/m"
[effects.pressure_dependent_friction.piston]
coefficient = "1e-5 m^2"
[effects.quadratic_drag.piston]
coefficient = "20 N s^2/m^2"
[effects.return_spring.piston]
stiffness = "200 N/m"
rest = "0.08 m"
[effects.presliding.piston]
stiffness = "2e5 N/m"
damping = "100 N s/m"
[effects.transmission_compliance.piston]
stiffness = "1e6 N/m"
[effects.backlash.piston]
gap = "0.2 mm"
[effects.coulomb_friction.slide]
force = "2 N"
[effects.unknown.piston]
acts = "flow_2"
depends_on = "position"
at = ["0 m", "80 mm", "160 mm"]
values = ["0 kg/s", "1e-5 kg/s", "-1e-5 kg/s"]
"""


@pytest.fixture
def bench(repository: Path) -> Path:
    return repository / "assets" / "bench.toml"


def start(path: Path, extra: str = "", x: float = 0.08) -> tuple[mujoco.MjModel, mujoco.MjData, PneumaticPlugin]:
    rig = parse(path.read_text() + extra, path)
    model = load(rig)
    data = mujoco.MjData(model)
    data.qpos[0] = x
    plugin = PneumaticPlugin(model, rig)
    plugin.reset(data, 3e5, 3.3e5)
    return model, data, plugin


def go(data: mujoco.MjData, plugin: PneumaticPlugin, steps: int) -> NDArray[np.float64]:
    out = []
    for _ in range(steps):
        plugin.command[:] = 0.3 * np.sin(2 * np.pi * data.time + np.arange(len(plugin.command)))
        plugin.step(data)
        out.append(np.concatenate([data.qpos, data.qvel, plugin.pressures().ravel(), plugin.force]))
    return np.array(out)


def test_bench_in_five_lines(bench: Path) -> None:
    rig = read(bench)
    model, data = (loaded := load(rig)), mujoco.MjData(loaded)
    plugin = PneumaticPlugin(model, rig)
    plugin.reset(data)
    plugin.command[0] = 1.0
    for _ in range(500):
        plugin.step(data)
    assert data.qpos[0] == pytest.approx(0.16, abs=2e-3)
    assert plugin.pressures()[0, 0] > 6e5


@pytest.mark.parametrize("extra", ["", EVERYTHING], ids=["paper", "everything"])
def test_a_snapshot_brings_back_the_same_future_to_the_last_bit(bench: Path, extra: str) -> None:
    model, data, plugin = start(bench, extra)
    go(data, plugin, 137)
    snapshot = plugin.snapshot(data)
    first = go(data, plugin, 200)
    books = plugin.books()
    plugin.restore(data, snapshot)
    assert (go(data, plugin, 200) == first).all()
    assert plugin.books().mass_residual == books.mass_residual
    other_data, other = mujoco.MjData(model), PneumaticPlugin(model, plugin.rig)
    other.restore(other_data, snapshot)
    assert (go(other_data, other, 200) == first).all()


def test_a_command_beyond_the_end_is_the_end(bench: Path) -> None:
    seen = {}
    for command in (1.0, 7.0):
        rig = read(bench)
        model = load(rig)
        data, plugin = mujoco.MjData(model), PneumaticPlugin(model, rig)
        plugin.reset(data, 3e5, 3e5)
        plugin.command[:] = command
        for _ in range(3):
            plugin.pneumatics.advance(plugin.lengths, plugin.lengths, plugin.command)
        seen[command] = plugin.pressures().copy()
    np.testing.assert_array_equal(seen[7.0], seen[1.0])


@pytest.mark.parametrize("short", [True, False])
def test_a_command_that_is_no_number_is_refused(bench: Path, short: bool) -> None:
    _, data, plugin = start(bench)
    plugin.command[:] = np.nan
    with pytest.raises(ModelError, match=r"cylinder piston: its valve command is nan: a controller must give a number from -1 to 1"):
        for _ in range(3):
            if short:
                plugin.step(data)
                plugin.command[:] = np.nan
            else:
                mujoco.mj_step1(plugin.model, data)
                plugin.advance(data)
                plugin.compute(data)
                mujoco.mj_step2(plugin.model, data)
    assert np.isfinite(plugin.pressures()).all()


@pytest.mark.parametrize(
    ("p_1", "p_2", "said"), [(np.nan, 3e5, "pressure_1 = nan"), (3e5, 0.0, "pressure_2 = 0"), (3e5, np.inf, "pressure_2 = inf")]
)
def test_chambers_are_not_filled_with_nothing(bench: Path, p_1: float, p_2: float, said: str) -> None:
    _, data, plugin = start(bench)
    before = plugin.pneumatics.vector.copy()
    with pytest.raises(ModelError, match=f"bench.toml: cylinder piston: {said} Pa at the start"):
        plugin.reset(data, p_1, p_2)
    np.testing.assert_array_equal(plugin.pneumatics.vector, before)


def test_a_gas_too_fast_for_its_step_is_refused_by_name(bench: Path) -> None:
    _, data, plugin = start(bench)
    plugin.pneumatics.cylinders["dead_volume_1"] = 1e-9
    plugin.pneumatics.cylinders["wall_heat_transfer"]["conductance"] = 1e3
    plugin.pneumatics.world["most_steps"] = 4.0
    data.qpos[0] = 0.0
    plugin.reset(data, 3e5, 3e5)
    with pytest.raises(ModelError, match=r"bench.toml: cylinder piston: chamber 1, .* less wall_heat_transfer"):
        for _ in range(20):
            data.qpos[0] = data.qvel[0] = 0.0
            plugin.step(data)
            plugin.command[:] = 0.5


def test_reset_forgets_everything(bench: Path) -> None:
    _, data, plugin = start(bench, EVERYTHING)
    first = go(data, plugin, 100)
    mujoco.mj_resetData(plugin.model, data)
    data.qpos[0] = 0.08
    plugin.reset(data, 3e5, 3.3e5)
    assert (go(data, plugin, 100) == first).all()


def test_books_close_with_everything_on(bench: Path) -> None:
    _, data, plugin = start(bench, EVERYTHING)
    found = go(data, plugin, 3000)
    assert np.isfinite(found).all()
    books = plugin.books()
    assert books.mass_residual < 1e-9 and books.energy_residual < 1e-9
    assert books.drawn[0] > 1e-3 and books.heat[0] != 0.0
    assert not data.warning.number.any()


def test_forces_of_others_on_a_joint_with_friction_stay(bench: Path) -> None:
    _, data, plugin = start(bench, '\n[effects.viscous_friction.slide]\ncoefficient = "50 N s/m"\n')
    data.qfrc_applied[0] = 7.0
    data.qvel[0] = 0.2
    for _ in range(50):
        plugin.step(data)
    felt = plugin.plant.felt[0]
    assert data.qfrc_applied[0] == pytest.approx(7.0 + felt, abs=1e-9)
    assert felt != 0.0
    data.qfrc_applied[0] += 3.0
    plugin.step(data)
    assert data.qfrc_applied[0] == pytest.approx(10.0 + plugin.plant.felt[0], abs=1e-9)


def test_joint_friction_is_the_friction_of_its_joint(bench: Path) -> None:
    _, data, plugin = start(bench, '\n[effects.coulomb_friction.slide]\nforce = "30 N"\n')
    data.qvel[0] = 0.3
    plugin.pneumatics.cylinders["vented"] = 1.0
    plugin.pneumatics.cylinders["valve_area"] = 1e-3
    plugin.reset(data)
    for _ in range(400):
        plugin.step(data)
    assert data.qvel[0] == pytest.approx(0.0, abs=1e-6)
    assert data.qpos[0] - 0.08 == pytest.approx(10.0 * 0.3**2 / (2 * 30.0), rel=0.05)


LEG = """
<mujoco model="bench">
  <option timestep="0.001"/>
  <worldbody>
    <site name="hip_base" pos="-0.12 0 0.1"/>
    <body>
      <joint name="hip" type="hinge" axis="0 1 0" damping="0.2" range="-40 40" limited="true"/>
      <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" mass="5"/>
      <site name="hip_end" pos="-0.05 0 -0.2"/>
      <site name="knee_base" pos="0.05 0 -0.1"/>
      <body pos="0 0 -0.4">
        <joint name="knee" type="hinge" axis="0 1 0" damping="0.2" range="0 80" limited="true"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" mass="3"/>
        <site name="knee_end" pos="0.06 0 -0.05"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <spatial name="hip"><site site="hip_base"/><site site="hip_end"/></spatial>
    <spatial name="knee"><site site="knee_base"/><site site="knee_end"/></spatial>
  </tendon>
  <actuator><motor name="hip" tendon="hip"/><motor name="knee" tendon="knee"/></actuator>
</mujoco>
"""


def test_two_cylinders_on_the_tendons_of_two_hinges(bench: Path, tmp_path: Path) -> None:
    (tmp_path / "bench.xml").write_text(LEG)
    text = bench.read_text()
    head, cylinder = text[: text.index("[cylinders")], text[text.index("[cylinders") :]
    for name, retracted in (("hip", "0.2 m"), ("knee", "0.25 m")):
        own = cylinder.replace("cylinders.piston", f"cylinders.{name}").replace('"piston"', f'"{name}"')
        head += own.replace('retracted_length = "0 m"', f'retracted_length = "{retracted}"') + "\n"
    rig = parse(head, tmp_path / "bench.toml")
    model = load(rig)
    data = mujoco.MjData(model)
    data.qpos[1] = 0.4
    plugin = PneumaticPlugin(model, rig)
    assert [link.joint for link in plugin.links] == ["hip", "knee"]
    plugin.reset(data, 3e5, 3e5)
    assert plugin.lengths == pytest.approx(data.actuator_length - [0.2, 0.25])
    for _ in range(1000):
        plugin.command[:] = 0.2 * np.sin(2 * np.pi * data.time), 0.2 * np.cos(2 * np.pi * data.time)
        plugin.step(data)
    assert plugin.books().mass_residual < 1e-10
    assert (plugin.books().drawn > 1e-5).all()
    assert data.ctrl == pytest.approx(plugin.force)


def test_gas_does_the_work_that_its_force_does(bench: Path) -> None:
    """The sum of rod force times displacement, and the atmosphere's, is the gas's work; the error falls with the step."""
    errors = []
    for step in (5e-4, 2.5e-4, 1.25e-4):
        rig = read(bench)
        model = load(rig)
        model.opt.timestep = step
        data = mujoco.MjData(model)
        data.qpos[0] = 0.08
        plugin = PneumaticPlugin(model, rig)
        plugin.reset(data, 3e5, 3.3e5)
        c, at, push = rig.cylinders["piston"], [], []
        for _ in range(round(0.3 / step) + 1):
            plugin.command[0] = 0.2 * np.sin(2 * np.pi * 3 * data.time)
            at.append(data.qpos[0])
            plugin.step(data)
            push.append(plugin.force[0] + rig.environment.pressure * (c.area_1 - c.area_2))
        errors.append(abs(np.trapezoid(push, at) - plugin.books().work[0]))
    assert errors[0] < 1e-3 * abs(plugin.books().work[0])
    assert errors[1] < 0.3 * errors[0] and errors[2] < 0.3 * errors[1]


def test_sensors_show_what_the_rig_says(bench: Path) -> None:
    effects = """
[effects.sensor_bias."piston.pressure_1"]
value = "2000 Pa"
[effects.sensor_scale."piston.pressure_1"]
factor = 1.1
[effects.sensor_delay.slide.position]
seconds = "10 ms"
"""
    rig = parse(bench.read_text() + effects, bench)
    time = np.arange(0.0, 1.0, 1e-3)
    truth = Recording(
        "run",
        time,
        {"piston.pressure_1": 3e5 + 1e5 * time, "piston.pressure_2": 2e5 + time, "slide.position": 0.1 * time},
        {"piston.pressure_1": "Pa", "piston.pressure_2": "Pa", "slide.position": "m"},
    )
    seen = observe(truth, rig)
    assert seen["piston.pressure_1"] == pytest.approx(1.1 * truth["piston.pressure_1"] + 2000.0)
    assert seen["piston.pressure_2"] is truth["piston.pressure_2"]
    assert seen["slide.position"][50:] == pytest.approx(0.1 * (time[50:] - 0.01))
    assert observe(truth, read(bench)) is truth
    wrong = parse(bench.read_text() + '\n[effects.sensor_bias."pistn.pressure_1"]\nvalue = "1 Pa"\n', bench)
    with pytest.raises(RigError, match=r"did you mean .piston.pressure_1"):
        observe(truth, wrong)


@pytest.mark.parametrize("where", ["piston", "slide"])
@pytest.mark.parametrize("step", [1e-3, 4e-3])
def test_a_stuck_load_stays_where_it_is_for_a_minute(bench: Path, where: str, step: float) -> None:
    rig = parse(bench.read_text() + f'\n[effects.coulomb_friction.{where}]\nforce = "20 N"\n', bench)
    model = load(rig)
    model.opt.timestep = step
    data = mujoco.MjData(model)
    data.qpos[0] = 0.08
    plugin = PneumaticPlugin(model, rig)
    plugin.pneumatics.cylinders["vented"] = 1.0
    plugin.reset(data)
    at = []
    for i in range(round(60.0 / step)):
        data.qfrc_applied[0] = 18.0 * min(1.0, i * step) + plugin.plant.felt.sum()
        plugin.step(data)
        at.append(data.qpos[0])
    assert np.ptp(at[len(at) // 20 :]) < 1e-8
    assert abs(at[-1] - 0.08) < 2e-4
    for _ in range(round(1.0 / step)):
        data.qfrc_applied[0] = 22.0 + plugin.plant.felt.sum()
        plugin.step(data)
    assert data.qpos[0] > 0.1


def test_one_cylinders_stroke_is_felt_by_another_on_the_same_supply_and_exhaust(bench: Path, tmp_path: Path) -> None:
    (tmp_path / "bench.xml").write_text(LEG)
    text = bench.read_text()
    head, cylinder = text[: text.index("[cylinders")], text[text.index("[cylinders") :]
    for name, retracted in (("hip", "0.2 m"), ("knee", "0.25 m")):
        own = cylinder.replace("cylinders.piston", f"cylinders.{name}").replace('"piston"', f'"{name}"')
        head += own.replace('retracted_length = "0 m"', f'retracted_length = "{retracted}"') + "\n"
    shared = '[effects.supply_droop.supply]\nvolume = "0.5 L"\nconductance = "1e-8 kg/(s Pa)"\n'
    shared += '[effects.exhaust_back_pressure.exhaust]\narea = "2 mm^2"\n'
    seen = {}
    for extra in ("", shared):
        rig = parse(head + extra, tmp_path / "bench.toml")
        model = load(rig)
        for busy in (0.0, 0.8):
            data = mujoco.MjData(model)
            data.qpos[1] = 0.4
            plugin = PneumaticPlugin(model, rig)
            plugin.reset(data, 3e5, 3e5)
            gas, still = plugin.pneumatics, plugin.lengths.copy()
            for i in range(300):  # rods locked: only the gas can carry news
                gas.advance(still, still, np.array([busy * (1.0 if i % 100 < 50 else -1.0), 0.3]))
            seen[extra, busy] = gas.pressures(still)[1]
            assert plugin.books().mass_residual < 1e-10
    assert seen["", 0.0] == pytest.approx(seen["", 0.8], rel=1e-6)  # stages of a step are shared, and so is their small error
    assert np.abs(seen[shared, 0.0] - seen[shared, 0.8]).max() > 1e3


@pytest.mark.parametrize("dead", ["0 cm^3", "0.1 cm^3", "1 cm^3"])
@pytest.mark.parametrize("step", [1e-3, 2.5e-4])
def test_a_piston_that_hits_its_ends_with_little_dead_volume_stays_finite(bench: Path, dead: str, step: float) -> None:
    rig = parse(bench.read_text().replace('"12 cm^3"', f'"{dead}"').replace('"10 cm^3"', f'"{dead}"'), bench)
    model = load(rig)
    model.opt.timestep = step
    data = mujoco.MjData(model)
    data.qpos[0] = 0.08
    plugin = PneumaticPlugin(model, rig)
    plugin.reset(data, 3e5, 3e5)
    highest = 0.0
    for _ in range(round(1.0 / step)):
        plugin.command[0] = 1.0 if data.time % 0.5 < 0.25 else -1.0
        plugin.step(data)
        highest = max(highest, plugin.pressures().max())
    assert np.isfinite(plugin.pressures()).all() and highest < 1e7
    assert not data.warning.number.any()
    assert plugin.books().mass_residual < 1e-9 and plugin.books().energy_residual < 1e-9


@pytest.mark.parametrize(
    "extreme",
    [
        '[effects.viscous_friction.piston]\ncoefficient = "1e5 N s/m"',
        '[effects.quadratic_drag.slide]\ncoefficient = "1e6 N s^2/m^2"',
        '[effects.coulomb_friction.piston]\nforce = "50 N"\n[effects.presliding.piston]\nstiffness = "1e9 N/m"\ndamping = "1e6 N s/m"',
        '[effects.transmission_compliance.piston]\nstiffness = "100 N/m"',
        '[effects.transmission_compliance.piston]\nstiffness = "1e10 N/m"',
        '[effects.backlash.piston]\ngap = "5 cm"',
        '[effects.wall_heat_transfer.piston]\nconductance = "1000 W/K"',
        '[effects.external_leakage.piston]\nlaminar_1 = "1e-12 kg/(s Pa^2)"',
        '[effects.supply_regulator.supply]\ndroop = "1e10 Pa s/kg"',
        '[effects.piston_leakage.piston]\narea = "100 mm^2"',
    ],
)
def test_effects_at_the_ends_of_their_bounds_stay_finite(bench: Path, extreme: str) -> None:
    _, data, plugin = start(bench, f"\n{extreme}\n")
    found = go(data, plugin, 600)
    assert np.isfinite(found).all() and not data.warning.number.any()
    assert plugin.books().mass_residual < 1e-9
