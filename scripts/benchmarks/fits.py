"""Three ways to fit the same numbers to the same recording: ours, mujoco's `sysid`, and scipy around plain Python."""

from __future__ import annotations

import contextlib
import io
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks.plain_cylinder import PlainCylinder
from benchmarks.task import LEAK, NAMES, Task, Trail
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.least_squares import fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.simulation.plugin import PneumaticPlugin

Array = NDArray[np.float64]

#: Errors are counted in units of this [Pa].
UNIT = 100.0


def ours(task: Task) -> Trail:
    """Fit as the search of the diagnosis does, on one core; the model is made anew, which belongs to the time."""
    path = Trail()
    model = GasModel([task.run], task.plant, Split({}), window=task.model.inputs[0].time[-1] * 2.0)

    def numbers(values: dict[FreeParameter, float]) -> Array:
        return np.array([values[q] for q in task.parameters]) / [1.0, 1.0, 1.0, LEAK]

    def residual(values: dict[FreeParameter, float]) -> Array:
        path.note(numbers(values))
        return model.residual(values)

    start = dict(zip(task.parameters, task.start * [1.0, 1.0, 1.0, LEAK], strict=True))
    path.end(numbers(fit(residual, task.parameters, start, max_iterations=24, tolerance=1e-5).values))
    return path


def plain_cylinder(task: Task) -> PlainCylinder:
    """Return the plain simulation of the machine as believed."""
    world, cylinder = task.plant.world[0], task.plant.cylinder[0]
    return PlainCylinder(
        *(float(world[key]) for key in ("k", "r", "supply_pressure", "exhaust_pressure", "supply_temperature")),
        *(float(cylinder[key]) for key in ("area_1", "area_2", "stroke")),
    )


def plain_pressures(task: Task, machine: PlainCylinder, numbers: Array) -> Array:
    """Return what the plain simulation predicts with these numbers, shape (n, 2) [Pa]."""
    cylinder, run = task.plant.cylinder[0], task.run
    believed = np.array([float(cylinder[key]) for key in NAMES[:3]])
    valve, dead_1, dead_2 = (believed * numbers[:3]).tolist()
    assert run.length is not None
    return machine.pressures(run.time, run.length, run.command, task.first.tolist(), valve, dead_1, dead_2, float(numbers[3]) * LEAK)


def by_scipy(task: Task) -> Trail:
    """Fit by `scipy.optimize.least_squares` around the plain simulation."""
    from scipy.optimize import least_squares

    machine, measured, path = plain_cylinder(task), task.pressure, Trail()

    def residual(numbers: Array) -> Array:
        path.note(numbers)
        return ((plain_pressures(task, machine, numbers) - measured) / UNIT).ravel()

    path.end(least_squares(residual, task.start, bounds=(task.low, task.high)).x)
    return path


class LedPiston:
    """The simulator's plug-in in MuJoCo with the joint led along the recorded positions: only the gas is free."""

    def __init__(self, task: Task) -> None:
        self.task, self.model = task, task.spec.compile()
        self.data = mujoco.MjData(self.model)
        self.plugin = PneumaticPlugin(self.model, task.rig)
        (cylinder,) = task.rig.cylinders.values()
        assert task.run.length is not None
        self.places = task.run.length + cylinder.retracted_length
        self.believed = self.plugin.pneumatics.cylinders.copy()

    def pressures(self, numbers: Array) -> Array:
        """Return both pressures at every sample with these numbers, shape (n, 2) [Pa]."""
        plugin, model, data = self.plugin, self.model, self.data
        record = plugin.pneumatics.cylinders
        for key, factor in zip(NAMES[:3], numbers[:3], strict=True):
            record[key] = self.believed[key] * factor
        record["piston_leakage"]["area"] = numbers[3] * LEAK
        mujoco.mj_resetData(model, data)
        data.qpos[0] = self.places[0]
        plugin.reset(data, *self.task.first)
        out = np.empty((len(self.places), 2))
        out[0] = plugin.pressures()[0]
        plugin.command[0] = self.task.run.command[0]
        for i in range(1, len(self.places)):
            data.time += plugin.dt
            data.qpos[0] = self.places[i]
            mujoco.mj_fwdPosition(model, data)
            plugin.advance(data)
            out[i] = plugin.pressures()[0]
            plugin.command[0] = self.task.run.command[i]
        return out


def by_sysid(task: Task) -> Trail:
    """Fit by `mujoco.sysid` with its own optimizer, and the led piston in the place of its rollout.

    Raises:
        ImportError: the package is there, what it needs is not.
    """
    from mujoco import sysid

    if not hasattr(sysid, "optimize"):
        import mujoco.sysid._src.optimize
        import mujoco.sysid.report.defaults  # noqa: F401  says what is missing

    from absl import logging

    logging.set_verbosity(logging.ERROR)  # it warns of sensors that the model lacks: they are ours
    led, measured = LedPiston(task), task.pressure
    led.pressures(task.start)  # compiles
    path = Trail()
    clock = np.arange(len(measured)) * led.plugin.dt
    kind = sysid.SignalType.CustomObs
    mapping = {"pressure_1": (kind, np.array([0])), "pressure_2": (kind, np.array([1]))}
    state = sysid.create_initial_state(led.model, led.places[:1])

    def rollout(*, models: Any, param_dicts: Any, initial_states: Any, control_signal: Any, **_: Any) -> list[Any]:
        found = []
        for model, parameters, initial, control in zip(models, param_dicts, initial_states, control_signal, strict=True):
            numbers = parameters.as_vector()
            path.note(numbers)
            predicted = sysid.TimeSeries(clock, led.pressures(numbers), mapping)
            states = sysid.TimeSeries(clock, np.column_stack([clock, led.places, np.zeros_like(clock)]))
            found.append(sysid.SystemTrajectory(model, control, predicted, initial, states))
        return found

    def compare(parameters: Any, predicted: Any, measured: Any, model: Any, every: bool, **_: Any) -> tuple[Array, Any, Any]:
        return ((predicted.data - measured.data) / UNIT).ravel(), predicted, measured

    control = sysid.TimeSeries(clock, task.run.command[:, None])
    sequences = sysid.ModelSequences(
        "bench", task.spec, "recording", state, control, sysid.TimeSeries(clock, measured, mapping), allow_missing_sensors=True
    )
    parameters = sysid.ParameterDict()
    for name, start, low, high in zip(NAMES, task.start, task.low, task.high, strict=True):
        parameters.add(sysid.Parameter(name, start, low, high))
    residual = sysid.build_residual_fn(
        models_sequences=[sequences], build_model=lambda parameters, spec: led.model, custom_rollout=rollout,
        modify_residual=compare, resample_true=False,
    )  # fmt: skip
    with contextlib.redirect_stdout(io.StringIO()):
        found, _ = sysid.optimize(parameters, residual, verbose=False)
    path.end(found.as_vector())
    return path
