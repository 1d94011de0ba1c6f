"""What is missing and has no name, read off the residual of a cut: as a force, or as a flow into a chamber."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.fitted_set import Trial
from exo_sim.diagnosis.gas_problem import GasProblem
from exo_sim.diagnosis.motion_problem import MotionProblem
from exo_sim.diagnosis.quantity import Setting
from exo_sim.diagnosis.supply_cut import SupplyProblem
from exo_sim.diagnosis.unknown import Curve, depends_on

Array = NDArray[np.float64]

#: A missing flow is read off the pressure error's rise over this time [s].
RISE = 0.05
#: A curve that predicts less than this share says nothing.
LEAST_EXPLAINED = 0.2


@dataclass(frozen=True)
class Nameless:
    """Something without a name.

    Attributes:
        acts: "force", "flow_1" or "flow_2".
        unit: Of what is missing.
        curves: Against each variable, the best first; variables of the simulator and others (command, time).
        size: Root mean square of what is missing.
    """

    acts: str
    unit: str
    curves: tuple[Curve, ...]
    size: float

    @property
    def best(self) -> Curve | None:
        """The curve that predicts most, if any predicts enough."""
        return self.curves[0] if self.curves and self.curves[0].explains > LEAST_EXPLAINED else None


def pattern_left(problem: GasProblem | MotionProblem | SupplyProblem, trial: Trial) -> float:
    """Return the largest share of what a trial leaves that follows one signal."""
    if isinstance(problem, SupplyProblem):
        return 0.0
    setting = problem.apply(trial.fit.values, trial.fixed)
    if isinstance(problem, MotionProblem):
        left = [missing_force(problem, setting)]
    else:
        left = [missing_flow(problem, setting, side) for side in set(problem.sides.tolist())]
    return max((curves.curves[0].explains for curves in left if curves.curves), default=0.0)


def missing_force(problem: MotionProblem, setting: Setting) -> Nameless:
    """Return the force that the balance lacks, + along the motion's positive direction, against what it may follow."""
    rows: dict[str, list[Array]] = {}
    lacking: list[Array] = []
    for index, run in enumerate(problem.runs):
        group = problem._groups[index]
        keep = group >= 0
        count = np.bincount(group[keep]).astype(float)

        def mean(
            values: Array, keep: NDArray[np.bool_] = keep, group: NDArray[np.int64] = group, count: Array = count
        ) -> Array:
            return np.bincount(group[keep], weights=values[keep]) / count

        variables = {"position": run.position, "velocity": run.velocity, "time": run.time - run.time[0]}
        if run.cylinder is not None:
            variables |= {
                "pressure_1": run.gauge[:, 0], "pressure_2": run.gauge[:, 1],
                "pressure_difference": run.gauge[:, 0] - run.gauge[:, 1],
            }  # fmt: skip
        for name, values in variables.items():
            rows.setdefault(name, []).append(mean(values))
        lacking.append(mean(problem.missing(setting, index) / np.where(np.abs(run.arm) > 1e-6, run.arm, 1.0)))
    force = np.concatenate(lacking)
    curves = depends_on({name: np.concatenate(values) for name, values in rows.items()}, force, problem.blocks)
    return Nameless("force", problem.unit, tuple(curves), float(np.sqrt(np.mean(force**2))))


def missing_flow(problem: GasProblem, setting: Setting, side: int) -> Nameless:
    """Return the mass flow that one chamber lacks [kg/s], + fills it, against what it may follow."""
    k, r = float(setting.world["k"][0]), float(setting.world["r"][0])
    rows: dict[str, list[Array]] = {}
    flows, blocks, offset = [], [], 0
    for index, errors in enumerate(problem.errors(setting)):
        feed = problem.feeds[index]
        run = feed.run
        error = errors[:, side]
        usable = problem.split.training(run.recording, run.time)
        temperature = problem.predict(setting, index).temperature[:, side]
        volume = _volume(setting, feed.length, side)
        step = max(2, int(round(RISE / float(np.median(np.diff(run.time))))))
        for window, (begin, end) in enumerate(zip(feed.windows.starts, feed.windows.stops, strict=True)):
            edges = np.arange(begin, end, step)
            for a, b in zip(edges[:-1], edges[1:], strict=True):
                half = slice(a, b)
                if not (usable[half].all() and np.isfinite(error[half]).all()):
                    continue
                slope = np.polyfit(run.time[half] - run.time[a], error[half], 1)[0]
                flows.append(float(volume[half].mean() / (k * r * temperature[half].mean()) * slope))
                blocks.append(window + offset)
                for name, values in _variables(run, feed.length).items():
                    rows.setdefault(name, []).append(np.array([values[half].mean()]))
        offset += len(feed.windows.starts)
    missing = np.array(flows)
    found = depends_on(
        {name: np.concatenate(values) for name, values in rows.items()}, missing, np.array(blocks, dtype=int)
    )
    return Nameless(
        f"flow_{side + 1}", "kg/s", tuple(found), float(np.sqrt(np.mean(missing**2))) if missing.size else 0.0
    )


def _volume(setting: Setting, length: Array, side: int) -> Array:
    c = setting.cylinder[0]
    return (
        c["dead_volume_1"] + c["area_1"] * length
        if side == 0
        else c["dead_volume_2"] + c["area_2"] * (c["stroke"] - length)
    )


def _variables(run: object, length: Array) -> dict[str, Array]:
    time: Array = run.time  # type: ignore[attr-defined]
    found = {"position": length, "velocity": run.speed, "valve_command": run.command, "time": time - time[0]}  # type: ignore[attr-defined]
    p_1, p_2 = run.pressure  # type: ignore[attr-defined]
    if p_1 is not None:
        found["pressure_1"] = p_1
    if p_2 is not None:
        found["pressure_2"] = p_2
    if p_1 is not None and p_2 is not None:
        found["pressure_difference"] = p_1 - p_2
    return found
