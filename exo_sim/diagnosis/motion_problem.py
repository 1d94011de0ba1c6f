"""The motion cut of one joint as a least-squares problem: numbers in, whitened missing force of the training time out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion

from exo_sim.diagnosis.motion_cut import MotionRun, as_smooth, resistance_along, smoothing
from exo_sim.diagnosis.quantity import Quantity, Setting
from exo_sim.diagnosis.split import Split

Array = NDArray[np.float64]

#: Balances are averaged over this time before they are compared [s].
GROUP = 0.02
#: Blocks of time that count as one witness [s].
BLOCK = 1.0
#: What a healthy machine's balance misses, as a share of the forces at work.
STRUCTURAL_SHARE = 0.008

#: ... and what no healthy machine's does, as a share of the same.
SICK_SHARE = 0.03
#: An effect that lowers the error by less than this share of the stall force is not worth a name.
MATERIAL_SHARE = 2e-4
#: What a healthy cylinder may lose in all before something is sick, as a share of its stall force.
NAMELESS = 0.003

#: Stiffness of a dry contact before it slides that any seal shows [N/m].
HEALTHY_CONTACT = 8e5


class MotionProblem:
    """One joint, any number of runs.

    Args:
        runs: Balances of the joint.
        setting: The machine as believed; its cylinder record holds what resists the motion.
        split: Which time may be used.
        held_out: Judge the kept time instead.
    """

    def __init__(self, runs: Sequence[MotionRun], setting: Setting, split: Split, held_out: bool = False):
        self.runs, self.setting = list(runs), setting
        self.setting.cylinder["effective_mass"] = self.runs[0].effective_mass
        if not self.runs[0].turning and float(self.setting.cylinder["presliding"]["stiffness"][0]) == 0.0:
            self.setting = self.setting.copy()
            self.setting.cylinder["presliding"]["stiffness"] = HEALTHY_CONTACT
        self.setting.cylinder["turning"] = float(self.runs[0].turning and self.runs[0].cylinder is None)
        self.unit = "N*m" if self.runs[0].turning else "N"
        self._groups: list[NDArray[np.int64]] = []
        blocks, scales, offset = [], [], 0
        for run in self.runs:
            usable = split.held_out(run.recording, run.time) if held_out else split.training(run.recording, run.time)
            group, block, count = _layout(run, usable)
            self._groups.append(group)
            blocks.append(block + offset)
            offset += int(block.max()) + 1 if block.size else 0
            per_row = max(1.0, run.every * GROUP / max(float(np.median(np.diff(run.time))), 1e-9))
            # neighbouring samples share the smoothing window: averaging GROUP of it gains little
            force = run.drive + run.external
            size = float(np.std(force)) + float(np.std(run.inertial))
            scale = np.hypot(run.noise, STRUCTURAL_SHARE * size) if count.size else 0.0
            scales.append(
                np.full(len(count), max(scale, 1e-9) * np.sqrt(min(1.0, 3.0 / per_row) if per_row > 3 else 1.0))
            )
        self.blocks = np.concatenate(blocks) if blocks else np.zeros(0, int)
        self.scale = np.concatenate(scales) if scales else np.zeros(0)

    @property
    def size(self) -> int:
        """How many rows the residual has."""
        return int(self.blocks.size)

    @property
    def filled_in(self) -> bool:
        """Whether a pressure in it was not measured."""
        return any(run.filled_in for run in self.runs)

    @property
    def material(self) -> float:
        """Drop of the root-mean-square error that matters, in units of the whitened rows."""
        floor = MATERIAL_SHARE * stall_force(self.runs[0], self.setting)
        return floor / float(np.median(self.scale)) if self.scale.size else 0.0

    @property
    def sick(self) -> float:
        """Root-mean-square error beyond which no healthy machine's balance is, in units of the whitened rows."""
        force = max(
            (float(np.std(run.drive + run.external)) + float(np.std(run.inertial)) for run in self.runs), default=0.0
        )
        floor = max(SICK_SHARE * force, NAMELESS * stall_force(self.runs[0], self.setting))
        return floor / float(np.median(self.scale)) if self.scale.size else 0.0

    def apply(self, values: dict[Quantity, float], fixed: Sequence[tuple[Quantity, float]] = ()) -> Setting:
        """Return the setting with these numbers put in."""
        setting = self.setting.copy()
        for quantity, value in (*values.items(), *fixed):
            quantity.put(setting, value)
        return setting

    def missing(self, setting: Setting, index: int) -> Array:
        """Return the force that the balance lacks at every sample of a run [N or N m], shape (n,)."""
        run, sensors = self.runs[index], setting.sensors
        resisted = np.empty(len(run.time))
        resistance_along(setting.cylinder[0], run.time, run.position, run.velocity, run.gauge, resisted)
        resisted = as_smooth(run.time, run.arm * resisted)  # as the measured forces are: a reversal is a step on neither side
        mass = sensors.get("payload_mass", 1.0)
        moved = (
            run.inertial
            + (sensors.get("inertia", 1.0) - 1.0) * (run.inertial - run.bias)
            + sensors.get("zero", 0.0) * run.tilt
        )
        passive = run.passive if run.damped is None else run.passive + (sensors.get("damping", 1.0) - 1.0) * run.damped
        found = mass * moved - passive - run.drive - run.external + resisted - sensors.get("offset", 0.0)
        for column, lever in run.levers.items():
            found = found + lever * sensors.get(f"{column}.bias", 0.0)
        for name, answer in run.unsure.items():
            found = found - answer * sensors.get(name, 0.0)
        for name, answer in run.leaks.items():
            found = found - answer * float(setting.cylinder["external_leakage"][name][0])
        return found

    def residual(self, values: dict[Quantity, float], fixed: Sequence[tuple[Quantity, float]] = ()) -> Array:
        """Return the whitened missing force for these numbers, shape (size,)."""
        return self.residual_of(self.apply(values, fixed))

    def residual_of(self, setting: Setting) -> Array:
        """Return the whitened missing force of a setting, shape (size,)."""
        pieces = []
        for index, group in enumerate(self._groups):
            keep = group >= 0
            if keep.any():
                missing = self.missing(setting, index)
                pieces.append(np.bincount(group[keep], weights=missing[keep]) / np.bincount(group[keep]))
        return np.concatenate(pieces) / self.scale if pieces else np.zeros(0)


def _layout(run: MotionRun, usable: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """Return group of each sample (-1: not compared), block of each group and its count; samples at rest are not compared.

    At rest dry friction takes any value up to its level: the balance says nothing of it.
    """
    time = run.time
    step = float(np.median(np.diff(time)))
    size = max(1, int(round(GROUP / step)))
    edge = max(2, int(round(0.5 * smoothing(time) / step)))
    turned = np.diff(np.signbit(run.velocity), prepend=run.velocity[0] < 0.0)  # between two samples that both move
    moving = binary_erosion((np.abs(run.velocity) > run.still) & ~turned, iterations=edge)
    good = usable & moving & np.isfinite(run.inertial + run.drive + run.external)
    for begin in run.breaks:
        good[max(0, begin - edge) : begin + edge] = False
    good[-edge:] = False
    group = np.full(len(time), -1)
    blocks: list[int] = []
    counts: list[float] = []
    for first in range(0, len(time), size):
        chosen = np.arange(first, min(first + size, len(time)))
        if good[chosen].all():
            group[chosen] = len(counts)
            counts.append(float(chosen.size))
            blocks.append(int((time[first] - time[0]) / BLOCK))
    return group, np.array(blocks, dtype=int), np.array(counts)


def stall_force(run: MotionRun, setting: Setting) -> float:
    """Return what the cylinder of a balance can push at most [N, N m at the joint]; 0 without a cylinder."""
    if run.cylinder is None:
        return 0.0
    gauge = float(setting.world["supply_pressure"][0] - setting.world["atmosphere"][0])
    return max(gauge, 0.0) * float(setting.cylinder["area_1"][0]) * float(np.median(np.abs(run.arm)))
