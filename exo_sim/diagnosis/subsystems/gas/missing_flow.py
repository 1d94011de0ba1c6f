"""The mass flow that a chamber lacks, read off the slope of its pressure error, and on which variable it depends."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.discrepancy.curve import fit_curves
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs
from exo_sim.diagnosis.subsystems.gas.prediction import GasPrediction

Array = NDArray[np.float64]

#: The slope of the pressure error is taken over this time [s].
RISE = 0.05


def missing_flow(
    predictions: Sequence[tuple[GasInputs, GasPrediction]], plant: PlantParameters, split: Split, side: int, place: str
) -> Discrepancy:
    """Return the mass flow that one chamber lacks [kg/s], positive where it fills the chamber: w = V / (k R T) dp/dt.

    Args:
        predictions: Inputs and prediction of every run.
        plant: What they were predicted with.
        split: Only training time counts.
        side: 0 or 1.
        place: Which balance that is, in words.
    """
    k, r = float(plant.world["k"][0]), float(plant.world["r"][0])
    rows: dict[str, list[Array]] = {}
    flows, blocks, offset = [], [], 0
    for given, predicted in predictions:
        run = given.run
        measured = run.pressure[side]
        error = np.full(len(run.time), np.nan) if measured is None else measured - predicted.pressure[:, side]
        usable = split.in_training(run.recording, run.time) & given.windows.compared
        temperature = predicted.temperature[:, side]
        volume = _volume(plant, given.length, side)
        step = max(2, int(round(RISE / float(np.median(np.diff(run.time))))))
        variables = _variables(run, given.length)
        for window, (begin, end) in enumerate(zip(given.windows.starts, given.windows.stops, strict=True)):
            edges = np.arange(begin, end, step)
            for a, b in zip(edges[:-1], edges[1:], strict=True):
                part = slice(a, b)
                if not (usable[part].all() and np.isfinite(error[part]).all()):
                    continue
                slope = np.polyfit(run.time[part] - run.time[a], error[part], 1)[0]
                flows.append(float(volume[part].mean() / (k * r * temperature[part].mean()) * slope))
                blocks.append(window + offset)
                for name, values in variables.items():
                    rows.setdefault(name, []).append(np.array([values[part].mean()]))
        offset += len(given.windows.starts)
    missing = np.array(flows)
    curves = fit_curves({name: np.concatenate(values) for name, values in rows.items()}, missing, np.array(blocks, dtype=int))
    size = float(np.sqrt(np.mean(missing**2))) if missing.size else 0.0
    return Discrepancy(f"flow_{side + 1}", "kg/s", place, curves, size)


def _volume(plant: PlantParameters, length: Array, side: int) -> Array:
    c = plant.cylinder[0]
    return (
        c["dead_volume_1"] + c["area_1"] * length
        if side == 0
        else c["dead_volume_2"] + c["area_2"] * (c["stroke"] - length)
    )


def _variables(run: CylinderRun, length: Array) -> dict[str, Array]:
    """Return what the flow may depend on, shape (n,) each."""
    assert run.speed is not None
    found = {"position": length, "velocity": run.speed, "valve_command": run.command, "time": run.time - run.time[0]}
    p_1, p_2 = run.pressure
    if p_1 is not None:
        found["pressure_1"] = p_1
    if p_2 is not None:
        found["pressure_2"] = p_2
    if p_1 is not None and p_2 is not None:
        found["pressure_difference"] = p_1 - p_2
    return found
