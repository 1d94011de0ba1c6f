"""The plug-in over MuJoCo's model and data: snapshots, refusals, energy, sensors."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from simulation.started import EVERYTHING, go, start

from exo_sim.errors import ModelError, RigError
from exo_sim.machine.rig_model import load
from exo_sim.recording.table import Recording
from exo_sim.rig import parse, read
from exo_sim.simulation.plugin import PneumaticPlugin
from exo_sim.simulation.sensors import observe


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


def test_chambers_are_not_filled_beyond_what_any_machine_has(bench: Path) -> None:
    _, data, plugin = start(bench)
    with pytest.raises(ModelError, match=r"bench.toml: pressure_2 = 1e\+300 Pa at the start is more than any machine has, 1e\+09 Pa"):
        plugin.reset(data, 3e5, 1e300)


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
