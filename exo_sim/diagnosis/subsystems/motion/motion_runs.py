"""Balances of forces behind the filter that suits them.

The usual filter of the clock serves most machines. Where noise of the positions says what the balance is worth, a wider one is asked for
(`filter_width`), but none behind which the machine turns round too soon for rows enough to be left. Where it turns round too soon for most
of its motion to be compared behind the usual one, a narrower one: that from which the rows tell most.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.data.open_questions import Unjudged
from exo_sim.diagnosis.policy.healthy import FORCE_FLOOR_SHARE
from exo_sim.diagnosis.policy.recordings import LEAST_COMPARED, ROWS_ENOUGH
from exo_sim.diagnosis.subsystems.motion.filter_width import WIDER, AskedWidth, asked_width
from exo_sim.diagnosis.subsystems.motion.inverse_dynamics import balances
from exo_sim.diagnosis.subsystems.motion.rows import rows_of
from exo_sim.diagnosis.subsystems.motion.smoothing import least_width, smoothing_width
from exo_sim.machine.linkage import Linkage
from exo_sim.recording.noise import white_noise
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

Judged = tuple[list[MotionRun], list[tuple[str, Unjudged]]]

#: Every narrower filter that is tried is by so much narrower than the one before, down to the least of the clock.
NARROWER = 1.6


def motion_runs(recording: Recording, rig: Rig, model: mujoco.MjModel, links: tuple[Linkage, ...]) -> Judged:
    """Return the balance of every joint that can be judged, and (joint, reason) for those that cannot; arguments as `balances`."""
    usual = balances(recording, rig, model, links, None)
    noisy = any(run.inertia.noise > FORCE_FLOOR_SHARE * run.effort for run in usual[0])
    quick = any(_compared(run) < LEAST_COMPARED for run in usual[0])
    if not noisy and not quick:
        return usual
    names = [model.joint(j).name for j in range(model.njnt)]
    positions = [recording[f"{name}.position"] for name in names]
    narrowest = smoothing_width(recording.time)
    if noisy:
        asked = asked_width(recording.time, positions, recording.breaks)
        if asked.seconds <= narrowest:
            return usual
        count, enough = len(usual[0]), ROWS_ENOUGH if _rows(usual[0]) >= ROWS_ENOUGH else 0
        del usual  # an hour of it beside that behind a wider filter is a tenth of a gigabyte
        while asked.seconds > narrowest:
            wider = balances(recording, rig, model, links, asked)
            if len(wider[0]) == count and _rows(wider[0]) >= enough:
                return wider
            asked = asked_width(recording.time, positions, recording.breaks, asked.seconds / WIDER)
        return balances(recording, rig, model, links, None)
    noise, still = tuple(white_noise(values) for values in positions), (0.0,) * len(names)
    tried = [AskedWidth(seconds, noise, still) for seconds in _narrower(narrowest, least_width(recording.time))]
    every = [usual, *(balances(recording, rig, model, links, one) for one in tried)]
    return max((one for one in every if len(one[0]) == len(usual[0])), key=lambda one: _worth(one[0]))


def _rows(runs: Sequence[MotionRun]) -> int:
    """Return how many rows the balance has that has fewest."""
    return min((rows_of(run, np.ones(len(run.time), dtype=bool)).block.size for run in runs), default=0)


def _narrower(usual: float, least: float) -> list[float]:
    """Return widths of narrower filters, from the widest on [s]."""
    count = max(int(math.log(usual / least) / math.log(NARROWER) + 1e-9), 0)
    return [usual / NARROWER ** (k + 1) for k in range(count)]


def _compared(run: MotionRun) -> float:
    """Return which share of the motion of a balance is compared; 1 where it never moves."""
    moves = np.abs(run.kinematics.velocity) > run.kinematics.still
    return float(rows_of(run, moves).compared.sum() / moves.sum()) if moves.any() else 1.0


def _worth(runs: Sequence[MotionRun]) -> float:
    """Return how much the rows of balances tell: the sum of their weights in units of the joints' effort, that of the worst balance."""
    rows = [rows_of(run, np.ones(len(run.time), dtype=bool)) for run in runs]
    return min(float(np.sum((run.effort / one.scale) ** 2)) for run, one in zip(runs, rows, strict=True))
