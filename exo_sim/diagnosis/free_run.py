"""The proof in one run: `improved.toml` itself, and the rig as believed, simulated from the first measured state to the end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.cases import Case, is_turned_round
from exo_sim.diagnosis.replay import FreeRun, free_run, usable
from exo_sim.diagnosis.result import SignalFit
from exo_sim.diagnosis.split import Spans, Split
from exo_sim.errors import ExoSimError
from exo_sim.machine.load import load
from exo_sim.recording import noise
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig, parse

Array = NDArray[np.float64]

#: No recordings that are longer than this together are simulated once more [s]: `compare` does it where it is asked to.
LONGEST = 600.0


def free_runs(case: Case, improved: str, spans: Spans) -> dict[str, SignalFit]:
    """Return, by column, the errors on the time kept back of one run that is not set right by any measurement on its way.

    Where the clock jumps it begins anew. Where the motion was led from outside by forces that nobody measured it is imposed in both
    runs, and only pressures are predicted. A valve command with the wrong sign is turned round, for a rig cannot say that. Empty where
    something would have to be assumed, or the recordings are long.

    Args:
        case: The recordings, and the rig as believed.
        improved: Text of the rig with what was found, as it would stand beside the rig.
        spans: The time kept back, by recording.
    """
    kept = [_judged_part(table, case) for table in case.as_read if table.name in spans]
    if sum(table.duration for table in kept) > LONGEST:
        return {}
    total: dict[str, _Sums] = {}
    with suppress(ExoSimError):  # nothing that can be predicted: what is missing has been said already
        believed, found = _Machine(case.rig), _Machine(parse(improved, case.rig.path))
        for table in kept:
            with suppress(ExoSimError):
                _add(total, table, believed, found, Split(spans).held_out(table.name, table.time))
    return {key: sums.result() for key, sums in total.items() if sums.count}


class _Machine:
    """A rig with its model."""

    def __init__(self, rig: Rig) -> None:
        self.rig, self.model = rig, load(rig)


def _judged_part(table: Recording, case: Case) -> Recording:
    """Return a recording from where its gas is judged, its valve commands with the sign that they were found to have."""
    begun = [run.time[0] for runs in case.cylinders.values() for run in runs if run.recording == table.name]
    table = table.span(max(begun, default=-math.inf), math.inf)
    wrong = {finding.where for finding in case.sensors if is_turned_round(finding)}
    return replace(table, columns={key: -values if key in wrong else values for key, values in table.columns.items()})


class _Sums:
    """Squares of the errors of one column before and after, over any number of recordings."""

    def __init__(self, unit: str) -> None:
        self.unit, self.count, self.squares, self.noise = unit, 0, np.zeros(2), 0.0

    def add(self, recorded: Array, runs: Sequence[Array]) -> None:
        """Count errors of shape (n,) before and after; what a lost simulation leaves is not finite, and so is the sum then."""
        with np.errstate(over="ignore", invalid="ignore"):
            self.squares += [float(np.sum((run - recorded) ** 2)) for run in runs]
        self.count += len(recorded)

    def result(self) -> SignalFit:
        before, after = np.sqrt(np.where(np.isfinite(self.squares), self.squares, math.nan) / self.count)
        return SignalFit(self.unit, float(before), float(after), self.noise)


def _add(total: dict[str, _Sums], table: Recording, believed: _Machine, improved: _Machine, mask: NDArray[np.bool_]) -> None:
    recorded, after = _run(table, improved, "auto")
    if after is None:
        return
    _, before = _run(table, believed, "recorded" if after.led else "predicted")
    if before is None:
        return
    mask = mask & after.simulated
    for key in (key for key in after.predicted.columns if key in before.predicted):
        there = mask & np.isfinite(recorded[key])
        if there.any():
            sums = total.setdefault(key, _Sums(table.units[key]))
            sums.add(recorded[key][there], [run.predicted[key][there] for run in (before, after)])
            sums.noise = max(sums.noise, noise.floor(recorded[key], recorded.time).std)


def _run(table: Recording, machine: _Machine, motion: str) -> tuple[Recording, FreeRun | None]:
    """Return what a rig lets one believe of a recording, and its run."""
    recorded, _ = usable(table, machine.rig, machine.model)
    return recorded, free_run(recorded, machine.rig, machine.model, motion=motion)
