"""What the plug-in is handed and cannot be: refused in one line, with nothing changed."""

from __future__ import annotations

import copy
import dataclasses
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from exo_sim.errors import ExoSimError, ModelError, RigError
from exo_sim.machine.rig_model import load
from exo_sim.rig import Rig, read
from exo_sim.simulation.plugin import PneumaticPlugin


@pytest.fixture
def bench(repository: Path) -> Rig:
    return read(repository / "assets" / "bench.toml")


def started(rig: Rig) -> tuple[mujoco.MjModel, mujoco.MjData, PneumaticPlugin]:
    model = load(rig)
    data, plugin = mujoco.MjData(model), PneumaticPlugin(model, rig)
    plugin.reset(data, 3e5, 3e5)
    return model, data, plugin


def steps(plugin: PneumaticPlugin, data: mujoco.MjData, count: int, short: bool) -> None:
    for _ in range(count):
        if short:
            plugin.step(data)
            continue
        mujoco.mj_step1(plugin.model, data)
        plugin.advance(data)
        plugin.compute(data)
        mujoco.mj_step2(plugin.model, data)


@pytest.mark.parametrize("pressure", [np.nan, np.inf, 0.0, -1e5, [3e5, 3e5], "high"])
def test_pressures_that_cannot_be(bench: Rig, pressure: Any) -> None:
    model = load(bench)
    data, plugin = mujoco.MjData(model), PneumaticPlugin(model, bench)
    plugin.reset(data, 3e5, 3e5)
    before = plugin.pressures()
    for place in (1, 2):
        given = {f"pressure_{place}": pressure}
        with pytest.raises(ModelError, match=f"pressure_{place}") as caught:
            plugin.reset(data, **given)
        assert "\n" not in str(caught.value)
    assert np.array_equal(plugin.pressures(), before)


def test_a_command_that_is_no_number(bench: Rig) -> None:
    model = load(bench)
    data, plugin = mujoco.MjData(model), PneumaticPlugin(model, bench)
    plugin.reset(data, 3e5, 3e5)
    plugin.step(data)
    before = data.time
    plugin.command[:] = np.nan
    with pytest.raises(ModelError, match="command"):
        plugin.step(data)
    assert data.time == before
    plugin.command[:] = 1e9  # more than fully open is fully open
    plugin.step(data)
    other = mujoco.MjData(model)
    twin = PneumaticPlugin(model, bench)
    twin.reset(other, 3e5, 3e5)
    twin.step(other)
    twin.command[:] = 1e9
    twin.step(other)
    assert np.array_equal(plugin.pressures(), twin.pressures())  # the step that was refused is taken, not left out


NO_GASES: list[dict[str, float]] = [
    *({"heat_capacity_ratio": value} for value in (1e6, 1.0, np.nan)),
    *({"specific_gas_constant": value} for value in (0.0, np.nan, np.inf)),
]


@pytest.mark.parametrize("change", NO_GASES)
def test_a_gas_that_cannot_be(bench: Rig, change: dict[str, float]) -> None:
    with pytest.raises(RigError, match="no gas has"):
        PneumaticPlugin(load(bench), dataclasses.replace(bench, **change))  # type: ignore[arg-type]


def test_the_state_of_another_model(bench: Rig, repository: Path) -> None:
    model = load(bench)
    plugin = PneumaticPlugin(model, bench)
    other = mujoco.MjData(mujoco.MjModel.from_xml_path(str(repository / "assets" / "exo.xml")))
    for step in (plugin.reset, plugin.step):
        with pytest.raises(ModelError, match="another model"):
            step(other)
    data = mujoco.MjData(model)
    plugin.reset(data)
    plugin.step(data)
    plugin.step(copy.deepcopy(data))  # a copy is of the same model


def test_a_thousand_resets_leave_nothing_behind(bench: Rig) -> None:
    """Memory stays where it was, and each run is the same to the bit."""
    import tracemalloc

    model = load(bench)
    data, plugin = mujoco.MjData(model), PneumaticPlugin(model, bench)

    def once() -> bytes:
        mujoco.mj_resetData(model, data)
        plugin.reset(data, 3e5, 3.3e5)
        plugin.command[:] = 0.5
        for _ in range(5):
            plugin.step(data)
        return plugin.pressures().tobytes()

    first = once()
    tracemalloc.start()
    for _ in range(50):
        assert once() == first
    used = tracemalloc.get_traced_memory()[0]
    for _ in range(950):
        assert once() == first
    assert tracemalloc.get_traced_memory()[0] < used + 20_000
    tracemalloc.stop()


def test_every_refusal_is_one_of_ours() -> None:
    assert issubclass(ModelError, ExoSimError) and issubclass(RigError, ExoSimError)


@pytest.mark.filterwarnings("ignore:.*simulation is unstable")
@pytest.mark.parametrize("short", [True, False])
@pytest.mark.parametrize("factor", [0.0, 0.25, 0.75, 2.0, -1.0, float("nan")])
def test_a_time_step_that_changed_is_refused(bench: Rig, factor: float, short: bool) -> None:
    model, data, plugin = started(bench)
    steps(plugin, data, 5, short)
    before = plugin.pressures().copy()
    model.opt.timestep = factor * plugin.dt
    with pytest.raises(ModelError, match=rf"time step became {factor * plugin.dt:g} s; the plug-in was made for {plugin.dt:g} s: make it"):
        steps(plugin, data, 3, short)
    np.testing.assert_allclose(plugin.pressures(), before, rtol=0.05)
    model.opt.timestep = plugin.dt
    mujoco.mj_resetData(model, data)
    plugin.reset(data, 3e5, 3e5)
    steps(plugin, data, 5, short)


def test_motors_that_were_edited_are_refused_at_the_next_reset(bench: Rig) -> None:
    edits = [
        (lambda model: model.actuator_gainprm.__setitem__((0, 0), 2.0), r"is not a <motor> of gain 1"),
        (lambda model: model.actuator_ctrllimited.__setitem__(0, 1) or model.actuator_ctrlrange.__setitem__(0, (-1.0, 1.0)), "ctrlrange"),
    ]
    for edit, says in edits:
        model, data, plugin = started(bench)
        edit(model)
        mujoco.mj_resetData(model, data)
        with pytest.raises(ModelError, match=says):
            plugin.reset(data)


@pytest.mark.parametrize("short", [True, False])
@pytest.mark.parametrize("field", ["qpos", "qvel", "qfrc_applied"])
@pytest.mark.filterwarnings("ignore:.*simulation is unstable")
def test_what_mujoco_reset_by_itself_is_no_machine_at_rest(bench: Rig, field: str, short: bool) -> None:
    _, data, plugin = started(bench)
    steps(plugin, data, 5, short)
    getattr(data, field)[:] = np.nan
    with pytest.raises(ModelError, match=r"MuJoCo's clock went back from 0.00[45] s to .* s: call the plug-in's reset after mj_resetData"):
        steps(plugin, data, 3, short)


@pytest.mark.parametrize("short", [True, False])
def test_steps_without_the_gas_are_refused(bench: Rig, short: bool) -> None:
    model, data, plugin = started(bench)
    steps(plugin, data, 2, short)
    for _ in range(3):
        mujoco.mj_step(model, data)
    with pytest.raises(ModelError, match=r"MuJoCo's clock is at 0.005 s and the gas at 0.001 s: bring the gas up in every step of 0.001 s"):
        steps(plugin, data, 1, short)


@pytest.mark.parametrize("data", [None, 3, "data"])
def test_what_is_no_data_is_refused(bench: Rig, data: Any) -> None:
    _, _, plugin = started(bench)
    for of in (plugin.step, plugin.advance, plugin.compute, plugin.reset):
        with pytest.raises(ModelError, match=f"takes the MjData of its model, not {type(data).__name__}"):
            of(data)


@pytest.mark.parametrize("place", [1e30, -5.0])
def test_a_piston_far_outside_its_stroke_is_refused(bench: Rig, place: float) -> None:
    _, data, plugin = started(bench)
    data.qpos[:] = place
    with pytest.raises(ModelError, match=r"cylinder piston: its piston is at .* its stroke is .* m: start within it"):
        plugin.reset(data)


def test_a_pressure_beyond_all_numbers_is_refused(bench: Rig) -> None:
    _, data, plugin = started(bench)
    with pytest.raises(ModelError, match="pressure_1: give one pressure in Pa"):
        plugin.reset(data, 10**400)
