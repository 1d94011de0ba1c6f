"""The task that all rivals of the clock are given: one short recording, four numbers, one start, the same bounds."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks import recordings
from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.subsystems.gas.candidates import candidates
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.gas.nuisances import nuisance_parameters
from exo_sim.rig import Rig, assembly

Array = NDArray[np.float64]

CONCEALED = "piston_leakage"
SECONDS = 3.0
#: The numbers: valve area and both dead volumes as shares of what is believed, and the leak's area in units of this [m^2].
NAMES = ("valve_area", "dead_volume_1", "dead_volume_2", "leak")
LEAK = 1e-8


@dataclass(frozen=True)
class Task:
    """What a rival is given.

    Attributes:
        rig, spec: The machine as believed, and its MuJoCo model.
        plant: Its records.
        run: Command, piston position and both pressures at every sample, as the diagnosis prepares them.
        first: Both pressures at the first sample, from the samples near it [Pa].
        parameters: The four numbers as the diagnosis has them; their bounds are everybody's.
        model: The diagnosis's own model, the recording one window; it is also what judges everybody's numbers.
        start: Where everybody begins, in the order of `NAMES`: as believed, and the leak as the search begins with it.
    """

    rig: Rig
    spec: mujoco.MjSpec
    plant: PlantParameters
    run: CylinderRun
    first: Array
    parameters: tuple[FreeParameter, ...]
    model: GasModel
    start: Array
    low: Array = field(default_factory=lambda: np.array([0.2, 0.2, 0.2, 0.0]))
    high: Array = field(default_factory=lambda: np.array([5.0, 5.0, 5.0, 20.0]))

    @property
    def pressure(self) -> Array:
        """Both measured pressures, shape (n, 2) [Pa]."""
        first, second = self.run.pressure
        assert first is not None and second is not None
        return np.column_stack([first, second])

    def error(self, numbers: Array) -> float:
        """Return the root-mean-square error of both pressures over the recording with these numbers [Pa]."""
        values = dict(zip(self.parameters, (*numbers[:3], numbers[3] * LEAK), strict=True))
        (errors,) = self.model.errors(self.model.apply(values))
        return float(np.sqrt(np.mean(errors**2)))


@dataclass
class Trail:
    """The numbers that a fit asked about, and when."""

    begun: float = field(default_factory=time.perf_counter)
    asked: list[tuple[float, Array]] = field(default_factory=list)
    taken: float = 0.0

    def note(self, numbers: Array) -> None:
        """Keep what was asked about now."""
        self.asked.append((time.perf_counter() - self.begun, np.array(numbers, dtype=float)))

    def end(self, numbers: Array) -> None:
        """Keep where the fit ended."""
        self.taken = time.perf_counter() - self.begun
        self.asked.append((self.taken, np.array(numbers, dtype=float)))


Fit = Callable[[Task], Trail]


def task() -> Task:
    """Make the recording and what everybody is given."""
    with tempfile.TemporaryDirectory() as folder:
        ((path, rig_path),) = recordings.write(Path(folder), CONCEALED, [SECONDS], supply=False)
        case = gather([path], rig_path)
        ((name, (run,)),) = case.cylinders.items()
        spec = mujoco.MjSpec.from_file(str(case.rig.model))
        plant = PlantParameters(assembly.world(case.rig), assembly.cylinders(case.rig))
        believed = {q.parameter: q for q in nuisance_parameters(plant, name, True, (1, 2))}
        joint = case.links[0].joint
        leak = next(c for c in candidates(plant, [run], name, joint) if (c.effect, c.form) == (CONCEALED, "area"))
    parameters = (*(replace(believed[key], prior=None) for key in NAMES[:3]), *leak.parameters)
    run = replace(run, commanded=False)  # all begin with a valve that was shut: no window need lead in
    model = GasModel([run], plant, Split({}), window=2.0 * SECONDS)
    start = np.array([1.0, 1.0, 1.0, leak.starts[0][0] / LEAK])
    return Task(case.rig, spec, plant, run, model.inputs[0].windows.pressure[0], parameters, model, start)
