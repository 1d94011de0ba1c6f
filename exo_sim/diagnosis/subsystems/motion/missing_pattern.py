"""What the force that a balance lacks depends on: a force along the piston's positive direction, or one against its motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.discrepancy.curve import fit_curves
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.subsystems.motion.rows import Rows

Array = NDArray[np.float64]


def force_or_friction(
    runs: Sequence[MotionRun], rows: Sequence[Rows], missing: Sequence[Array], blocks: NDArray[np.int64], unit: str, balance: str
) -> tuple[Discrepancy, Discrepancy]:
    """Return what a balance lacks at the piston as a force along its positive direction, and as one against its motion.

    Args:
        runs: The balance in every recording.
        rows: Its rows in each.
        missing: What it lacks in each at every sample [N or N m], shape (n,).
        blocks: Block of time of all rows, or of these and more behind them.
        unit, balance: Of the subsystem.
    """
    variables: dict[str, list[Array]] = {}
    forces: list[Array] = []
    ways: list[Array] = []
    for run, own, lacking in zip(runs, rows, missing, strict=True):
        for name, values in signals_of(run).items():
            variables.setdefault(name, []).append(own.means(values))
        ways.append(np.sign(own.means(run.kinematics.velocity)))
        forces.append(own.means(lacking / run.drive.divisor))
    force, joined = np.concatenate(forces), {name: np.concatenate(values) for name, values in variables.items()}
    size, blocks = float(np.sqrt(np.mean(force**2))), blocks[: force.size]
    along = fit_curves(joined, force, blocks)
    against = tuple(replace(one, resists=True) for one in fit_curves(joined, -force * np.concatenate(ways), blocks))
    return Discrepancy("force", unit, balance, along, size), Discrepancy("friction", unit, balance, against, size)


def closer_over(both: Sequence[Discrepancy], variables: Sequence[str]) -> Discrepancy:
    """Return what a balance lacks as what follows variables more closely, a force or a friction, its curves over these first.

    Args:
        both: It as a force, and as a friction.
        variables: What it is known to depend on.
    """
    asked = [replace(one, curves=tuple(sorted(one.curves, key=lambda c: (c.variable not in variables, -c.explains)))) for one in both]
    other, closer = sorted(asked, key=lambda one: one.pattern)
    return replace(closer, otherwise=other.pattern)


def signals_of(run: MotionRun) -> dict[str, Array]:
    """Return what a missing force may depend on, shape (n,) each."""
    found = {"position": run.kinematics.position, "velocity": run.kinematics.velocity, "time": run.time - run.time[0]}
    if run.cylinder is not None:
        first, second = run.drive.gauge[:, 0], run.drive.gauge[:, 1]
        found |= {"pressure_1": first, "pressure_2": second, "pressure_difference": first - second}
    return found
