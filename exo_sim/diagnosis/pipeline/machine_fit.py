"""The numbers of an improved rig, fitted together to the whole machine, each within its interval.

A gas is fitted under its recorded motion, and forces under recorded pressures. What either leaves open by a per cent (a moving mass, an
edge of a valve) decides where a machine goes that both move together: its piston integrates every such error. So all numbers are moved
once more by one step of Gauss and Newton on windows of the whole machine, with a penalty for every standard error that one moves by.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.outcome.rig_numbers import OpenNumber, open_numbers, with_numbers
from exo_sim.diagnosis.outcome.rig_update import RigUpdate
from exo_sim.diagnosis.policy.budgets import MACHINE_DIFFERENCE, MACHINE_WEIGHINGS
from exo_sim.diagnosis.validation.training_runs import Errors, TrainingRuns
from exo_sim.errors import ModelError, RigError
from exo_sim.rig import parse

Array = NDArray[np.float64]


def fitted_to_machine(
    data: MachineData, update: RigUpdate, split: Split, threads: Threads = SERIAL, is_spent: IsSpent = never
) -> RigUpdate:
    """Return an update whose numbers were fitted to the training time of the whole machine; the same one where that gains nothing.

    Numbers of the gas and of the motion must both be open: else one would make up for the other's errors.

    Args:
        data: The recordings, and the rig as handed in.
        update: What was found.
        split: Its training time is fitted to.
        threads: For the runs, one for each number.
        is_spent: Whether the time is up: then nothing is run, and what was begun is not used.
    """
    numbers = open_numbers(update)
    if not {"gas", "motion"} <= {number.cut for number in numbers} or is_spent():
        return update
    try:
        fit = _MachineFit(data, update, numbers, split)
    except (RigError, ModelError):  # acceptance says so
        return update
    return fit.after_a_step(threads, is_spent)


class _MachineFit:
    """Numbers of a rig, and what windows of the whole machine are missed by with other values of them."""

    def __init__(self, data: MachineData, update: RigUpdate, numbers: tuple[OpenNumber, ...], split: Split) -> None:
        self._folder, self._path = data.rig.path.parent, data.rig.path
        self._update, self._numbers = update, numbers
        self._runs = TrainingRuns(data, split, parse(update.text(self._folder), self._path))

    def after_a_step(self, threads: Threads, is_spent: IsSpent) -> RigUpdate:
        """Return the update after the step or half of it, or as it was where neither lowers the errors by more than it is penalised."""
        here = np.zeros(len(self._numbers))
        errors = None if self._runs.is_empty else self._errors(here)
        if errors is None:
            return self._update

        def response(j: int) -> Errors:
            return self._response(j, errors) if not is_spent() else {}

        moves = threads.predictions(response, range(len(here)))
        if is_spent():
            return self._update
        line = Linearised(errors, {key: np.stack([move[key] for move in moves], axis=1) for key in errors})
        ends = np.array([[(q.low - q.value) / q.error, (q.high - q.value) / q.error] for q in self._numbers])
        step, weights = weighed_step(line, ends, self._runs)
        for share in (1.0, 0.5):
            after = self._errors(share * step)
            if after is not None and cost(after, weights, share * step) < cost(errors, weights, here):
                return self._at(share * step)
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


@dataclass(frozen=True)
class Linearised:
    """Errors, to first order in what numbers are moved by, in units of their standard errors.

    Attributes:
        errors: By column, where nothing is moved, shape (n,).
        responses: By column, their derivatives, shape (n, p).
    """

    errors: Errors
    responses: Errors

    def at(self, moved: Array) -> Errors:
        """Return the errors where numbers are moved, shape (p,)."""
        return {key: own + self.responses[key] @ moved for key, own in self.errors.items()}


def weighed_step(line: Linearised, ends: Array, runs: TrainingRuns) -> tuple[Array, dict[str, float]]:
    """Return by how much each number is moved in units of its standard error, shape (p,), and the weight of each column.

    The error of a window grows with time, so that its samples are far from independent, and what the numbers move is no such error: for
    how much a sample counts is taken from what the step leaves, again and again until that changes no more. Few independent samples count
    for less, for the numbers follow their errors.

    Args:
        line: The errors.
        ends: How far each number may move down and up, shape (p, 2).
        runs: What they are errors of.
    """
    moved, free = np.zeros(len(ends)), 0.0
    weights: dict[str, float] = {}
    for _ in range(MACHINE_WEIGHINGS):
        left = line.at(moved)
        counts = runs.independent(left)
        total = sum(counts.values())
        spare = total / (total + free)
        weights = {key: spare * counts[key] / len(own) / max(float(own @ own) / len(own), 1.0) for key, own in left.items()}
        curvature = sum((weights[key] * (rows.T @ rows) for key, rows in line.responses.items()), np.eye(len(ends)))
        slope = sum((weights[key] * (rows.T @ line.errors[key]) for key, rows in line.responses.items()), np.zeros(len(ends)))
        root = np.linalg.cholesky(curvature)
        before = moved
        moved = lsq_linear(root.T, -solve_triangular(root, slope, lower=True), (ends[:, 0], ends[:, 1])).x
        free = len(ends) - float(np.trace(np.linalg.inv(curvature)))
        if np.abs(moved - before).max() < 0.01:
            break
    return moved, weights


def cost(errors: Errors, weights: dict[str, float], moved: Array) -> float:
    """Return the weighed sum of squared errors, with the penalty for what was moved."""
    return float(moved @ moved) + sum(weights[key] * float(own @ own) for key, own in errors.items())
