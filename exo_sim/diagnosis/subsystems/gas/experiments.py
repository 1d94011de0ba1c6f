"""Recordings that could be made of one cylinder's gas, as runs that a plant can be asked to predict."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.estimation.parameters import PlantParameters

Array = NDArray[np.float64]

#: Samples of an experiment [s] and its length [s].
STEP, LENGTH = 1e-3, 4.0


def menu(like: CylinderRun, plant: PlantParameters) -> dict[str, CylinderRun]:
    """Return runs by what is to be done.

    Args:
        like: A run of the cylinder, for its stroke, its sensors and whether its valve is commanded.
        plant: The nominal machine, for its supply.
    """
    assert like.length is not None
    time = np.arange(0.0, LENGTH, STEP)
    low, high = float(np.nanmin(like.length)), float(np.nanmax(like.length))
    middle, swing = 0.5 * (low + high), 0.5 * (high - low)
    room, supply = float(plant.world["atmosphere"][0]), float(plant.world["supply_pressure"][0])
    still, closed = np.full_like(time, middle), np.zeros_like(time)
    square = np.sign(np.sin(2.0 * np.pi * time))
    ramp = np.interp(time, [0.0, 0.25 * LENGTH, 0.75 * LENGTH, LENGTH], [0.0, 0.3, -0.3, 0.0])

    def level(share: float) -> float:
        return room + share * (supply - room)

    hold = "hold the valve closed and the piston still for {:.0f} s, both chambers at {} of the supply pressure"
    found = {
        hold.format(LENGTH, "nine tenths"): (closed, still, (level(0.9), level(0.9))),
        hold.format(LENGTH, "a third"): (closed, still, (level(0.3), level(0.3))),
        f"hold the valve closed and the piston still for {LENGTH:.0f} s, one chamber full and the other empty": (
            closed, still, (level(0.9), level(0.05)),
        ),
        "with the valve closed, move the piston over its stroke once a second": (
            closed, middle + swing * np.sin(2.0 * np.pi * time), (level(0.4), level(0.4)),
        ),
        "block the piston, and switch the valve fully from one side to the other, once a second": (square, still, (level(0.5), level(0.5))),
        "block the piston, and open the valve by a few hundredths at the most, slowly and to both sides": (
            0.15 * ramp, still, (level(0.5), level(0.5)),
        ),
        "block the piston, and take the command slowly to a third of its range on both sides": (ramp, still, (level(0.5), level(0.5))),
    }  # fmt: skip
    if not like.commanded:
        found = {do: what for do, what in found.items() if not what[0].any()}
    return {do: _run(like, time, *what) for do, what in found.items()}


def _run(like: CylinderRun, time: Array, command: Array, length: Array, start: tuple[float, float]) -> CylinderRun:
    first, second = (np.full_like(time, value) if known is not None else None for value, known in zip(start, like.pressure, strict=True))
    return CylinderRun(
        recording="experiment", cylinder=like.cylinder, time=time, command=command, length=length, speed=np.gradient(length, time),
        pressure=(first, second), supply=None, exhaust=None, supply_temperature=None, force=None,
        commanded=like.commanded, noise=like.noise, breaks=(0,), initial=start,
    )  # fmt: skip
