"""A recording, simulated: the rig's whole machine under the recorded commands, supply and outside forces."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RecordingError, nearest
from exo_sim.machine.rig_model import load
from exo_sim.recording import health
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig
from exo_sim.signals import SHARED_PARTS, VALVE_COMMANDS
from exo_sim.simulation.replay.machine import RecordedMachine
from exo_sim.simulation.sensors import observe, seen_through

Array = NDArray[np.float64]

#: Length of a window [s].
WINDOW = 0.5


@dataclass(frozen=True)
class Replay:
    """What a rig predicts of a recording, on the recording's clock, as its sensors would show it.

    Attributes:
        windowed: Predicted columns, started anew from the measured state every `WINDOW` seconds; NaN where the simulation diverged.
        free_run: The same in one run from the first measured state. Positions only where motion is predicted.
        imposed: Joints whose motion was imposed as recorded, and why; one imposed joint means that all are.
        remarks: Plain sentences about what was assumed.
    """

    windowed: Recording
    free_run: Recording
    imposed: Mapping[str, str]
    remarks: tuple[str, ...]

    @property
    def measure(self) -> str:
        """What the errors are, in words."""
        how = "motion led as recorded" if self.imposed else "motion predicted too"
        return f"rms of {WINDOW:g} s predictions, and of one run from the first measured state; {how}"


def check_belongs(recording: Recording, rig: Rig, model: mujoco.MjModel) -> tuple[str, ...]:
    """Return remarks on parts that the rig does not have.

    Raises:
        RecordingError: the recording is of another machine, or never mentions a cylinder of the rig.
    """
    joints = [model.joint(j).name for j in range(model.njnt)]
    sites = [model.site(i).name for i in range(model.nsite)]
    parts = recording.parts()
    own = [part for part in parts if part in rig.cylinders or part in joints]
    there = [part for part in parts if part not in SHARED_PARTS]
    if not own:
        known = [*rig.cylinders, *(name for name in joints if name not in rig.cylinders)]
        listed = ", ".join(there[:4]) or "no part of a machine"
        raise RecordingError(
            f'"{recording.name}": it holds {listed}, but the rig {rig.path} has {", ".join(known)}; '
            "give the rig of this machine, or a column map"
        )
    for name in rig.cylinders:
        if not any(f"{name}.{signal}" in recording for signal in (*VALVE_COMMANDS, "pressure_1", "pressure_2")):
            strange = [part for part in there if part not in rig.cylinders]
            raise RecordingError(
                f'"{recording.name}": no valve command and no pressure of cylinder "{name}" of {rig.path}{nearest(name, strange)}'
            )
    strange = [part for part in there if part not in own and part not in sites]
    return tuple(f'"{part}" is no part of the rig; its columns were not used' for part in strange)


def usable(recording: Recording, rig: Rig, model: mujoco.MjModel) -> tuple[Recording, list[health.Finding]]:
    """Return a recording without the samples that its sensors, as this rig knows them, cannot have seen, and what was noticed."""
    odd = list(health.check(seen_through(recording, rig)[0], health.Facts.of(rig, model)))
    return health.without_faults(recording, odd), odd


def replay(
    recording: Recording, rig: Rig, model: mujoco.MjModel | None = None, *, motion: str = "auto", window: float = WINDOW,
    progress: Callable[[float], None] | None = None,
) -> Replay:  # fmt: skip
    """Simulate what was recorded.

    Measured pressures and positions are predicted: over windows, each from the measured state at its start (gas temperatures, spools
    and dry contacts, which nothing measures, are carried over from window to window), and in one run from the first state. Where
    joints were driven by forces that nobody measured, or not all of them were recorded, motion is imposed as recorded and only
    pressures are predicted.

    Args:
        recording: Signals in SI.
        rig: The machine.
        model: Its model, where it is loaded already.
        motion: "predicted", "recorded", or "auto": predicted unless `external_drive.externally_driven` says otherwise.
        window: Length of a window [s].
        progress: Called with the share done, 0 to 1.

    Raises:
        RecordingError: the recording is of another machine, or holds nothing that can be predicted.
        ModelError: the model lacks a part of the rig.
    """
    model = load(rig) if model is None else model
    remarks = list(check_belongs(recording, rig, model))
    machine, imposed, wanted = _ready(recording, rig, model, motion)
    remarks += [f"motion of {name} is led as recorded: {why}" for name, why in imposed.items()]
    remarks += [*machine.imposed_pressures(), *machine.assumed()]
    report = progress or (lambda share: None)
    windowed = machine.run(window, bool(imposed), lambda share: report(0.5 * share))
    free = machine.run(math.inf, bool(imposed), lambda share: report(0.5 + 0.5 * share))
    shown = [_shown(recording, rig, {key: values[key] for key in wanted}) for values in (windowed, free)]
    return Replay(shown[0], shown[1], imposed, tuple(remarks))


@dataclass(frozen=True)
class Run:
    """A recording predicted over windows of one length, or in one run from the first measured state.

    Attributes:
        predicted: As `Replay.windowed` or `Replay.free_run`.
        simulated: Which samples it covers, shape (n,); too short stretches between two jumps of the clock are left out.
        imposed: Whether motion was imposed as recorded.
    """

    predicted: Recording
    simulated: NDArray[np.bool_]
    imposed: bool


def run(
    recording: Recording, rig: Rig, model: mujoco.MjModel, *, motion: str = "auto", window: float = math.inf,
    early: Mapping[str, float] | None = None,
) -> Run | None:  # fmt: skip
    """Simulate what was recorded over windows, or in one run; None where something that it depends on was not recorded.

    Pressures that are led belong to the motion that was recorded with them: away from it whatever feeds the chambers would have done
    something else, so that a rig is not judged by how far it strays under them.

    Args:
        recording, rig, model, motion: As for `replay`.
        window: Length of a window [s]; infinite for one run.
        early: By column of valve commands, how long before each sample it is held [s]; nil where absent.

    Raises:
        RecordingError, ModelError: as `replay`.
    """
    machine, imposed, wanted = _ready(recording, rig, model, motion, early)
    begun = [f"{c.name}.pressure_{side}" for c in rig.cylinders.values() for side in ((1,) if c.single_acting else (1, 2))]
    if machine.assumed() or machine.led or any(key not in recording for key in begun):
        return None
    values = machine.run(window, bool(imposed), lambda share: None)
    simulated = np.zeros(len(recording.time), dtype=bool)
    for piece in machine.pieces:
        simulated[piece.first : piece.last] = True
    return Run(_shown(recording, rig, {key: values[key] for key in wanted}), simulated, bool(imposed))


def _ready(
    recording: Recording, rig: Rig, model: mujoco.MjModel, motion: str, early: Mapping[str, float] | None = None
) -> tuple[RecordedMachine, dict[str, str], list[str]]:
    """Return the machine, the joints whose motion is imposed and why, and the columns to be predicted."""
    machine = RecordedMachine(seen_through(recording, rig)[0], rig, model, early)
    imposed = machine.imposed(motion)
    keys = machine.predictable(bool(imposed))
    wanted = [key for key in keys if np.isfinite(recording.columns.get(key, np.zeros(0))).any()]
    if not wanted:
        raise RecordingError(
            f'"{recording.name}": nothing in it can be predicted; it needs the position of a joint, and a pressure, a valve command '
            "or an outside force"
        )
    return machine, imposed, wanted


def rms(recorded: Array, predicted: Array) -> float:
    """Return the root mean square difference where something was recorded; NaN where the simulation diverged."""
    there = np.isfinite(recorded)
    return float(np.sqrt(np.mean((predicted[there] - recorded[there]) ** 2))) if there.any() else math.nan


def _shown(recording: Recording, rig: Rig, columns: dict[str, Array]) -> Recording:
    """Return predicted columns as the rig's sensors show them."""
    units = {key: recording.units[key] for key in columns}
    sensing = tuple(e for e in rig.effects if e.where in columns or not e.name.startswith("sensor_"))
    return observe(Recording(recording.name, recording.time, columns, units), replace(rig, effects=sensing))
