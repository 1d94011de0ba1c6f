"""The improved rig as far as it wins: run free over the time kept back it may not be worse than the rig that was handed in."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.outcome.rig_update import RigUpdate
from exo_sim.diagnosis.policy.validation import MOST_WORSE
from exo_sim.diagnosis.validation.free_run import free_runs


def accepted(data: MachineData, update: RigUpdate, folder: Path, split: Split) -> tuple[RigUpdate, dict[str, SignalFit], bool]:
    """Return as much of an update as wins run free, its errors, and whether something of it was left out.

    Args:
        data: The recordings, and the rig as believed.
        update: What was found.
        folder: Of the rig as believed.
        split: Its test time counts.
    """
    variants = update.variants()
    for one in variants:
        runs = free_runs(data, one.text(folder), split)
        if not is_worse(runs, {column: spread_of(data, column) for column in runs}):
            break
    return one, runs, one is not update


def spread_of(data: MachineData, column: str) -> float:
    """Return the standard deviation of a signal over all recordings that have it, in its unit; infinite where none has."""
    parts = [table[column] for table in data.recordings if column in table.columns]
    return float(np.nanstd(np.concatenate(parts))) if parts else math.inf


def is_worse(runs: Mapping[str, SignalFit], spreads: Mapping[str, float]) -> bool:
    """Return whether the errors of a free run rose, over its signals together; also where a run with the update diverges.

    A signal that neither run predicts better than its own mean would says nothing: a piston that slides wherever a tenth of a newton
    lets it is nowhere near either way.

    Args:
        runs: Errors of the free runs, by signal.
        spreads: Standard deviations of the signals.
    """
    logs = []
    for column, fit in runs.items():
        if math.isfinite(fit.before) and fit.before > 0.0:
            if not math.isfinite(fit.after):
                return True
            if min(fit.before, fit.after) > spreads.get(column, math.inf):
                continue
            logs.append(math.log(max(fit.after, 1e-300) / fit.before))
    return bool(logs) and sum(logs) / len(logs) > math.log1p(MOST_WORSE)
