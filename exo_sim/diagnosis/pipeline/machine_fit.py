"""The numbers of an improved rig, fitted together to the whole machine, each within its interval.

A gas is fitted under its recorded motion, and forces under recorded pressures. What either leaves open by a per cent (a moving mass, an
edge of a valve) decides where a machine goes that both move together: its piston integrates every such error. So all numbers are moved
once more by one step of Gauss and Newton on windows of the whole machine, where what they were known to before is their prior.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.outcome.rig_numbers import OpenNumber, open_numbers, with_numbers
from exo_sim.diagnosis.outcome.rig_update import RigUpdate
from exo_sim.diagnosis.policy.budgets import MACHINE_DAMPING, MACHINE_DIFFERENCE
from exo_sim.diagnosis.validation.training_runs import Errors, TrainingRuns
from exo_sim.errors import ModelError, RigError
from exo_sim.rig import parse

Array = NDArray[np.float64]


def fitted_to_machine(
    data: MachineData, update: RigUpdate, split: Split, threads: Threads = SERIAL, is_spent: IsSpent = never
) -> RigUpdate:
    """Return an update whose numbers were fitted to the training time of the whole machine; the same one where that gains nothing.

    Args:
        data: The recordings, and the rig as handed in.
        update: What was found.
        split: Its training time is fitted to.
        threads: For the runs, one for each number.
        is_spent: Whether the time is up: then nothing is run.
    """
    numbers = open_numbers(update)
    if not numbers or is_spent():
        return update
    try:
        fit = _MachineFit(data, update, numbers, split)
    except (RigError, ModelError):  # acceptance says so
        return update
    return fit.after_a_step(threads, is_spent)


class _MachineFit:
    """A posterior over numbers of a rig: windows of the whole machine, and what each number was known to before.

    The error of a window grows with time, so that its samples are far from independent. What the numbers move is no such error: how large
    a column's is, and for how many independent samples it counts, is taken from what no numbers explain.
    """

    def __init__(self, data: MachineData, update: RigUpdate, numbers: tuple[OpenNumber, ...], split: Split) -> None:
        self._folder, self._path = data.rig.path.parent, data.rig.path
        self._update, self._numbers = update, numbers
        self._runs = TrainingRuns(data, split, parse(update.text(self._folder), self._path))

    def after_a_step(self, threads: Threads, is_spent: IsSpent) -> RigUpdate:
        """Return the update after the step, or as it was where that lowers no posterior."""
        here = np.zeros(len(self._numbers))
        errors = None if self._runs.is_empty else self._errors(here)
        if errors is None:
            return self._update
        moves = threads.predictions(lambda j: self._response(j, errors), range(len(here)))
        responses = {key: np.stack([move[key] for move in moves], axis=1) for key in errors}
        unexplained = _unexplained(errors, responses)
        counts = self._runs.independent(unexplained)
        weights = {key: counts[key] / len(own) / max(_mean_square(own), 1.0) for key, own in unexplained.items()}
        curvature, slope = np.eye(len(here)), np.zeros(len(here))
        for key, rows in responses.items():
            curvature += weights[key] * (rows.T @ rows)
            slope += weights[key] * (rows.T @ errors[key])
        before = _cost(errors, weights, here)
        for damping in (0.0, MACHINE_DAMPING):
            if is_spent():
                break
            step = -np.linalg.solve(curvature + damping * np.diag(np.diag(curvature)), slope)
            moved = np.array([(q.at(d) - q.value) / q.error for q, d in zip(self._numbers, step, strict=True)])
            after = self._errors(moved)
            if after is not None and _cost(after, weights, moved) < before:
                return self._at(moved)
        return self._update

    def _response(self, j: int, errors: Errors) -> Errors:
        """Return the derivative of all errors by a number in units of its standard error; nil where it cannot move."""
        q = self._numbers[j]
        for side in (1.0, -1.0):
            by = (q.at(side * MACHINE_DIFFERENCE) - q.value) / q.error
            there = self._errors(by * (np.arange(len(self._numbers)) == j)) if abs(by) > 0.5 * MACHINE_DIFFERENCE else None
            if there is not None:
                return {key: (there[key] - own) / by for key, own in errors.items()}
        return {key: np.zeros(len(own)) for key, own in errors.items()}

    def _errors(self, moved: Array) -> Errors | None:
        """Return the errors with numbers moved by so many standard errors; None where that is no machine, or leaves all bounds."""
        try:
            return self._runs.errors(parse(self._at(moved).text(self._folder), self._path))
        except (RigError, ModelError):
            return None

    def _at(self, moved: Array) -> RigUpdate:
        return with_numbers(self._update, {q.place: q.at(float(d)) for q, d in zip(self._numbers, moved, strict=True)})


def _unexplained(errors: Errors, responses: Errors) -> Errors:
    """Return what is left of errors whatever the numbers are, to first order, every column weighing as much as another."""
    scales = {key: math.sqrt(_mean_square(own) * len(own)) or 1.0 for key, own in errors.items()}
    rows = np.concatenate([responses[key] / scales[key] for key in errors])
    moved = np.linalg.lstsq(rows, -np.concatenate([own / scales[key] for key, own in errors.items()]), rcond=None)[0]
    return {key: own + responses[key] @ moved for key, own in errors.items()}


def _cost(errors: Errors, weights: Mapping[str, float], moved: Array) -> float:
    """Return twice the negative logarithm of the posterior, but for a constant."""
    return float(moved @ moved) + sum(weights[key] * float(own @ own) for key, own in errors.items())


def _mean_square(errors: Array) -> float:
    return float(errors @ errors) / len(errors)
