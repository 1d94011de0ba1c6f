"""The proof in one run: `improved.toml` itself, and the rig as believed, simulated from the first measured state to the end."""

from __future__ import annotations

import math

import numpy as np

from exo_sim.diagnosis.cases import Case
from exo_sim.diagnosis.replay import free_run, usable
from exo_sim.diagnosis.result import SignalFit
from exo_sim.diagnosis.split import Spans, Split
from exo_sim.errors import ExoSimError
from exo_sim.machine.load import load
from exo_sim.recording import noise
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

#: No recordings that are longer than this together are simulated once more [s]: `compare` does it where it is asked to.
LONGEST = 600.0


def free_runs(case: Case, improved: Rig, spans: Spans) -> dict[str, SignalFit]:
    """Return, by column, the errors on the time kept back of one run that never meets a measured state again.

    Where the motion was led from outside by forces that nobody measured it is imposed in both runs, and only pressures are predicted.
    Empty where nothing can be predicted, or the recordings are long.

    Args:
        case: The recordings, and the rig as believed.
        improved: The rig with what was found.
        spans: The time kept back, by recording.
    """
    kept = [table for table in case.as_read if table.name in spans]
    if sum(table.duration for table in kept) > LONGEST:
        return {}
    total: dict[str, _Sums] = {}
    for table in kept:
        try:
            _add(total, table, case.rig, improved, spans)
        except ExoSimError:  # nothing that can be predicted: what is missing has been said already
            continue
    return {key: sums.result() for key, sums in total.items() if sums.count}


class _Sums:
    """Squares of the errors of one column before and after, over any number of recordings."""

    def __init__(self, unit: str) -> None:
        self.unit, self.count, self.squares, self.noise = unit, 0, np.zeros(2), 0.0

    def result(self) -> SignalFit:
        before, after = np.sqrt(np.where(np.isfinite(self.squares), self.squares, math.nan) / self.count)
        return SignalFit(self.unit, float(before), float(after), self.noise)


def _add(total: dict[str, _Sums], table: Recording, believed: Rig, improved: Rig, spans: Spans) -> None:
    model = load(improved)
    recorded, _ = usable(table, improved, model)
    after, led = free_run(recorded, improved, model)
    plain = load(believed)
    before, _ = free_run(usable(table, believed, plain)[0], believed, plain, motion="recorded" if led else "predicted")
    mask = Split(spans).held_out(table.name, table.time)
    for key in after.columns:
        there = mask & np.isfinite(recorded[key])
        if key not in before.columns or not there.any():
            continue
        sums = total.setdefault(key, _Sums(table.units[key]))
        errors = [_squares(run, recorded, key, there) for run in (before, after)]
        sums.squares += errors
        sums.count += int(np.count_nonzero(there))
        sums.noise = max(sums.noise, noise.floor(recorded[key], recorded.time).std)


def _squares(run: Recording, recorded: Recording, key: str, there: np.ndarray) -> float:
    """Return the sum of squared errors; not finite where the simulation was lost."""
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.sum((run[key][there] - recorded[key][there]) ** 2))
