"""The supply cut: what all cylinders drew goes in, the pressure upstream of their valves comes out.

Where the supply was recorded it explains the cylinders as it is; why it sags is a question of its own, and one for all of them.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.filters import white_noise
from exo_sim.diagnosis.quantity import Candidate, Quantity, Setting
from exo_sim.diagnosis.split import Split
from exo_sim.physics import chamber
from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects import supply_droop, supply_regulator
from exo_sim.physics.effects.declaration import Effect, declared

Array = NDArray[np.float64]

#: Errors are averaged over this time before they are compared [s].
GROUP = 0.01
#: Blocks of time that count as one witness [s].
BLOCK = 1.0
#: What no sensor and no flow model of a healthy machine keeps, as a share of the pressure.
FLOOR_SHARE = 2e-4
#: How far the set pressure of a regulator may be off, one standard deviation.
SET_SPREAD = 0.02
#: A supply that strays from its mean by less than this share is nobody's worry, and one that strays further is a finding.
HEALTHY_SHARE = 2e-3


@dataclass
class SupplyRun:
    """The supply in one recording: measured pressure [Pa] and what was drawn from it [kg/s], shape (n,) each."""

    recording: str
    time: Array
    pressure: Array
    drawn: Array
    noise: float


@kernel
def follow_supply(world, time, drawn, offset, out):
    """Run accumulator and regulator along a drawn flow.

    Args:
        world: Record WORLD, shape (1,).
        time, drawn: [s] and [kg/s], shape (n,).
        offset: Of the set pressure [Pa].
        out: Pressure upstream of the valves [Pa], shape (n,).
    """
    w = world[0]
    k, r, t_s = w.k, w.r, w.supply_temperature
    source = w.supply_pressure + offset
    cp = k * r / (k - 1.0)
    tank = supply_droop.present(w.supply_droop)
    volume = w.supply_droop.volume
    mass, energy = 0.0, 0.0
    if tank:
        energy = source * volume / (k - 1.0)
        mass = source * volume / (r * t_s)
    felt, held = 0.0, 0.0
    for i in range(time.size):
        p_source = supply_regulator.pressure(w.supply_regulator, source, held)
        out[i] = chamber.pressure(energy, volume, k) if tank else p_source
        if i + 1 == time.size:
            break
        h = time[i + 1] - time[i]
        flow = drawn[i]
        if tank:
            steps = 1 + min(int(2.0 * h * k * r * t_s * w.supply_droop.conductance / volume), 200)
            flow = 0.0
            for _ in range(steps):
                p = chamber.pressure(energy, volume, k)
                fed = supply_droop.feed(w.supply_droop, p_source, p)
                t = chamber.temperature(energy, mass, k, r)
                mass = max(mass + h / steps * (fed - drawn[i]), 1e-9)
                energy = max(energy + h / steps * cp * (fed * t_s - drawn[i] * t), 1e-6)
                flow += fed / steps
        felt = supply_regulator.follow(w.supply_regulator, felt, flow, h, 0.0)
        held = supply_regulator.stick(w.supply_regulator, held, felt)


class SupplyProblem:
    """The supply of a machine as a least-squares problem, any number of recordings.

    Args:
        runs: Pressure and drawn flow.
        setting: The machine as believed.
        split: Which time may be used.
        held_out: Judge the kept time instead.
    """

    unit = "Pa"

    def __init__(self, runs: Sequence[SupplyRun], setting: Setting, split: Split, held_out: bool = False):
        self.runs, self.setting = list(runs), setting
        self.group: list[NDArray[np.int64]] = []
        blocks, scales, offset = [], [], 0
        for run in self.runs:
            chosen = split.held_out(run.recording, run.time) if held_out else split.training(run.recording, run.time)
            bins = np.floor((run.time - run.time[0]) / GROUP).astype(np.int64)
            good = chosen & np.isfinite(run.pressure)
            used, group = np.unique(bins[good], return_inverse=True)
            whole = np.full(len(run.time), -1)
            whole[good] = group
            self.group.append(whole)
            blocks.append((used * GROUP / BLOCK).astype(np.int64) + offset)
            offset += int(blocks[-1].max()) + 1 if used.size else 0
            count = np.bincount(group, minlength=used.size)
            floor = FLOOR_SHARE * float(np.nanmean(run.pressure))
            scales.append(np.sqrt(run.noise**2 / np.maximum(count, 1) + floor**2))
        self.blocks = np.concatenate(blocks) if blocks else np.zeros(0, np.int64)
        self.scale = np.concatenate(scales) if scales else np.zeros(0)

    @property
    def size(self) -> int:
        """How many rows the residual has."""
        return int(self.blocks.size)

    @property
    def material(self) -> float:
        """Root-mean-square error that matters, in units of the whitened rows."""
        level = max((float(np.nanmean(run.pressure)) for run in self.runs), default=0.0)
        return HEALTHY_SHARE * level / float(np.median(self.scale)) if self.scale.size else 0.0

    @property
    def sick(self) -> float:
        """Root-mean-square error beyond which no healthy supply is, in units of the whitened rows."""
        return 10.0 * self.material

    def apply(self, values: dict[Quantity, float], fixed: Sequence[tuple[Quantity, float]] = ()) -> Setting:
        """Return the setting with these numbers put in."""
        setting = self.setting.copy()
        for quantity, value in (*values.items(), *fixed):
            quantity.put(setting, value)
        return setting

    def predict(self, setting: Setting, index: int) -> Array:
        """Return the predicted supply pressure of one run [Pa], shape (n,)."""
        run = self.runs[index]
        out = np.empty(len(run.time))
        follow_supply(setting.world, run.time, run.drawn, setting.sensors.get("supply_pressure", 0.0), out)
        return out

    def residual(self, values: dict[Quantity, float], fixed: Sequence[tuple[Quantity, float]] = ()) -> Array:
        """Return the whitened errors for these numbers, shape (size,)."""
        return self.residual_of(self.apply(values, fixed))

    def residual_of(self, setting: Setting) -> Array:
        """Return the whitened errors of a setting, shape (size,)."""
        pieces = []
        for index, (run, group) in enumerate(zip(self.runs, self.group, strict=True)):
            keep = group >= 0
            error = (run.pressure - self.predict(setting, index))[keep]
            pieces.append(np.bincount(group[keep], weights=error) / np.maximum(np.bincount(group[keep]), 1))
        return np.concatenate(pieces) / self.scale if pieces else np.zeros(0)


def supply_run(recording: str, time: Array, pressure: Array, drawn: Array) -> SupplyRun:
    """Return a run with its sensor noise estimated."""
    return SupplyRun(recording, time, pressure, drawn, white_noise(pressure))


def believed(setting: Setting) -> tuple[Quantity, ...]:
    """Return the one believed number: the set pressure."""
    spread = SET_SPREAD * float(setting.world["supply_pressure"][0])
    return (Quantity("supply_pressure", "supply", "supply_pressure", "Pa", "sensor", spread, -1e6, 1e6, (0.0, spread)),)


def candidates(setting: Setting) -> tuple[Candidate, ...]:
    """Return the questions that a measured supply can be asked: a tank that sags, a regulator that droops."""
    found = []
    shared = [effect for effect in declared().values() if effect.places == ("supply",)]
    for effect, form in ((e, form) for e in shared for form in e.asked.forms or (tuple(p.name for p in e.parameters),)):
        if setting.is_on(effect):
            continue
        quantities = tuple(_quantity(effect, parameter) for parameter in form)
        starts = tuple(itertools.product(*([_between(effect, p, share) for share in (0.15, 0.5, 0.85)] for p in form)))
        found.append(Candidate(effect.name, "supply", "+".join(form), quantities, starts, proportional=False))
    return tuple(found)


def _between(effect: Effect, name: str, share: float) -> float:
    low, high = effect.parameter(name).typical
    return low * (high / low) ** share


def _quantity(effect: Effect, name: str) -> Quantity:
    parameter = effect.parameter(name)
    return Quantity(
        effect.name,
        "supply",
        name,
        parameter.unit,
        "world",
        _between(effect, name, 0.5),
        parameter.low,
        parameter.high,
        rough=name == "hysteresis",
        wide=effect.name == "supply_droop",
    )
