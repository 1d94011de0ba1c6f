"""Errors of a rig itself over windows: its subsystems on the test time with the numbers that stand in it, nothing fitted."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.correlation import rms
from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.outcome.rig_update import curve_of
from exo_sim.diagnosis.pipeline.gas_stage import nominal_gas
from exo_sim.diagnosis.pipeline.motion_stage import nominal_balance
from exo_sim.diagnosis.pipeline.plan import Plan
from exo_sim.diagnosis.pipeline.reading import gather_again
from exo_sim.diagnosis.policy.budgets import LEAD, LONGEST_FREE_RUN
from exo_sim.diagnosis.subsystem_model import Comparison
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.validation.recorded_run import judged_part
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

#: Rms error, unit and noise of the sensor, by column or balance.
Errors = Mapping[str, tuple[float, str, float]]


class WindowErrors:
    """Errors of rigs over windows of 0.5 s, and of their balances of forces.

    A balance of which a pressure was not measured is left out: what fills it in is fitted.

    Args:
        data: The recordings, and the rig as handed in, after the examination.
        split: Its test time counts.
        of_whole: Errors on other time, of recordings that are not cut to it: what the rigs make of them is known from there.
    """

    def __init__(self, data: MachineData, split: Split, of_whole: WindowErrors | None = None) -> None:
        self._data, self._plan = data, Plan(split)
        self._tables: list[Recording]
        self._tables, self._is_cut = _judged(data, split) if of_whole is None else (of_whole._tables, False)
        self._seen: dict[bool, tuple[Rig, MachineData]] = {} if of_whole is None else of_whole._seen
        self._guessed = {joint for joint, runs in data.joints.items() if any(run.imputed is not None for run in runs)}
        self._sampled = {(name, run.recording) for name, runs in data.cylinders.items() for run in runs if run.sampled}
        self._before: Errors | None = None

    def over(self, split: Split) -> WindowErrors:
        """Return the errors on another test time: of recordings that are not cut to it what the rigs make of them is known already."""
        return WindowErrors(self._data, split, None if self._is_cut else self)

    def errors(self, improved: Rig) -> dict[str, SignalFit]:
        """Return the errors of the rig as handed in and of an improved one; of long recordings only the test time is run, if that is short.

        What only the rig as handed in predicts has no error after that is a number.

        Raises:
            RigError, ModelError: the improved rig cannot be a machine.
        """
        if sum(table.duration for table in self._tables) > LONGEST_FREE_RUN:
            return {}
        if self._before is None:
            self._before = self._of(self._data.rig)
        after = self._of(improved)
        return {
            key: SignalFit(unit, error, after[key][0] if key in after else math.nan, noise)
            for key, (error, unit, noise) in self._before.items()
        }

    def _as_seen(self, rig: Rig) -> MachineData:
        """Return the recordings as a rig sees them; of short ones what the one handed in and the latest improved one see is kept."""
        if self._is_cut:
            return gather_again(self._data, rig, self._tables)
        place = rig is self._data.rig
        if place not in self._seen or self._seen[place][0] is not rig:
            self._seen[place] = rig, gather_again(self._data, rig, self._tables)
        return self._seen[place][1]

    def _of(self, rig: Rig) -> Errors:
        """Return the errors of one rig."""
        data, split = self._as_seen(rig), self._plan.split
        every: list[Comparison] = []
        for name, cylinder in data.cylinders.items():
            read = [replace(run, sampled=(name, run.recording) in self._sampled) for run in cylinder]
            plant = nominal_gas(data, self._plan, name, read)
            every += GasModel.over_test_time(read, plant, split).compared(plant, plant)
        for name, balances in data.joints.items():
            if name not in self._guessed:
                model = MotionModel(balances, nominal_balance(data, name, balances), split).on_test_time(split)
                every += model.compared(model.nominal, model.nominal, curve_of(rig, model.where))
        parts: dict[str, list[Comparison]] = {}
        for one in every:
            parts.setdefault(one.series.signal, []).append(one)
        found = {}
        for key, those in parts.items():
            error = rms(np.concatenate([one.error_after for one in those]))
            found[key] = (error, those[0].series.unit, max(one.series.noise for one in those))
        return found


def _judged(data: MachineData, split: Split) -> tuple[list[Recording], bool]:
    """Return what is judged of the recordings, and whether that is no more than their test time with its lead: of long ones."""
    tables = [judged_part(table, data) for table in data.as_read]
    if sum(table.duration for table in tables) <= LONGEST_FREE_RUN:
        return tables, False
    whole = {table.name: table for table in tables}
    spans = [(name, *span) for name, those in split.test.items() if name in whole for span in those]
    return [whole[name].span(begin - LEAD, np.nextafter(end, math.inf)) for name, begin, end in spans], True
